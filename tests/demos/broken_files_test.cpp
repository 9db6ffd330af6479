#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using testing::HasSubstr;

struct ProgramResult {
    int exitCode = -1;
    std::string errors;
};

/// Runs the program with what it prints to the error stream kept.
ProgramResult ragtop(const std::string& arguments) {
    const std::string command = std::string("cd '") + RAGTOP_SOURCE_DIR "/tests/broken' && '" RAGTOP_PROGRAM "' " +
                                arguments + " 2>&1 >/dev/null";
    std::FILE* pipe = popen(command.c_str(), "r");
    ProgramResult result;
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe)) result.errors += buffer.data();
    const int status = pclose(pipe);
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    return result;
}

/// What the program is asked, and what its one line must say: where, what is there, what is allowed.
struct Broken {
    std::string name;
    std::string arguments;
    std::vector<std::string> says;
};

std::ostream& operator<<(std::ostream& out, const Broken& broken) { return out << broken.arguments; }

class BrokenFile : public testing::TestWithParam<Broken> {};

TEST_P(BrokenFile, IsRefusedInOneLineThatNamesPlaceValueAndWhatIsAllowed) {
    const ProgramResult result = ragtop(GetParam().arguments);
    EXPECT_EQ(result.exitCode, 2) << result.errors;
    ASSERT_FALSE(result.errors.empty());
    EXPECT_EQ(result.errors.find('\n'), result.errors.size() - 1) << result.errors;
    for (const std::string& text : GetParam().says) EXPECT_THAT(result.errors, HasSubstr(text));
}

/// The file is the test's name.
Broken scene(const std::string& name, std::vector<std::string> says) {
    return {name, "inspect " + name + ".json", std::move(says)};
}
Broken car(const std::string& name, std::vector<std::string> says) {
    return {name, "inspect " + name + ".car.json", std::move(says)};
}
Broken ragdoll(const std::string& name, std::vector<std::string> says) {
    return {name, "inspect " + name + ".ragdoll.json", std::move(says)};
}

const std::vector<Broken> kText{
    scene("truncated", {"truncated.json:3:", "is not JSON"}),
    scene("nan", {"nan.json:2:", "is not JSON", "invalid literal"}),
    scene("not_json", {"not_json.json:1:1:", "is not JSON"}),
    scene("empty", {"empty.json:1:1:", "is empty"}),
    scene("root_array", {"root_array.json:1:1: /", "an object"}),
    scene("trailing_garbage", {"trailing_garbage.json:1:17:", "is not JSON"}),
    scene("bad_utf8", {"bad_utf8.json:1:", "is not JSON", "UTF-8"}),
    scene("overflow", {"overflow.json:2:", "overflow"}),
    scene("duplicate_key", {"duplicate_key.json:3:3:", "/duration occurs twice"}),
    scene("too_deep", {"too_deep.json:1:", "64"}),
};

const std::vector<Broken> kScenes{
    scene("wrong_type", {"wrong_type.json:3:15: /duration is \"ten\"", "a number in [0, 1000000] s"}),
    scene("unknown_key", {"unknown_key.json:2:26: /settings/gravty is unknown", "did you mean \"gravity\"?"}),
    scene("missing_field", {"missing_field.json:2:14: /bodies/0/shape is missing", "box, sphere"}),
    scene("missing_reference",
          {"missing_reference.json:2:25: /vehicles/0/file is \"no_such.car.json\"", "must name a file"}),
    scene("self_reference", {"/include/0 is \"self_reference.json\"", "must not lead back"}),
    scene("round_trip_a", {"round_trip_b.json:1:14: /include/0 is \"round_trip_a.json\"", "must not lead back"}),
    scene("bad_quaternion", {"/bodies/0/rotation is [0,0,0.5,0.5] of length 0.7071", "unit quaternion"}),
    scene("friction_range", {"/materials/ice/friction is -0.1", "in [0, 10]"}),
    scene("unknown_shape", {"/bodies/0/shape/bix is unknown", "did you mean \"box\"?"}),
    scene("two_shapes", {"/bodies/0/shape is {sphere, capsule}", "one of box, sphere"}),
    scene("negative_radius", {"/bodies/0/shape/sphere/radius is -0.5", "in [0.0001, 100000] m"}),
    scene("bad_enum",
          {"/bodies/0/type is \"dynamc\"", "\"fixed\", \"kinematic\", \"dynamic\"", "did you mean \"dynamic\"?"}),
    scene("short_vector", {"/bodies/0/position is [0,1]", "[x, y, z]"}),
    scene("flat_hull", {"/bodies/0/shape/hull makes no shape"}),
    scene("ragged_heights", {"/bodies/0/shape/heightField makes no shape", "heights/1 has 2 numbers, must have 3"}),
    scene("mesh_index", {"/bodies/0/shape/mesh makes no shape"}),
    scene("dynamic_mesh", {"/bodies/0", "open at the edge of vertices 0 and 1", "must be solid"}),
    scene("missing_mesh", {"/bodies/0/shape/mesh is \"no_such.obj\"", "must name a file"}),
    scene("missing_character", {"/ragdolls/0/character is \"no_such.glb\"", "must name a file"}),
    scene("missing_robot", {"missing_robot.json:2:38: /robots/0/file is \"no_such.urdf\"", "must name a file"}),
    scene("wrong_robot", {"wrong_robot.json:2:38: /robots/0/file is \"mass_abc.urdf\"", "must name a usable file",
                          "mass_abc.urdf:3: link 'base': mass value is 'abc', must be a number"}),
    scene("robot_link", {"/joints/0/a is \"arm/foream\"", "one of the 10 links", "did you mean \"forearm\"?"}),
    scene("robot_holding", {"robot_holding.json:2:86: /robots/0/holding is \"home\"", "must be a boolean"}),
    scene("cloth_row", {"cloth_row.json:2:69: /cloths/0/holds/0/row is 8", "must be one of the 8 rows"}),
    scene("cloth_forms", {"cloth_forms.json:2:14: /cloths/0 has 2 of", "must have exactly one"}),
    scene("cloth_density",
          {"cloth_density.json:2:39: /cloths/0/density is \"silk\"", "a number in [0.001, 1000] kg/m²"}),
    scene("cloth_hold", {"/cloths/0/holds/0/to is \"mats\"", "must be the name of one of"}),
    scene("ragdoll_pose", {"/ragdolls/0/pose/0 is", "must have the role and side of a part"}),
    scene("unknown_material", {"/bodies/0/material is \"brik\"", "did you mean \"brick\"?"}),
    scene("script_order", {"/vehicles/0/script/1 has the time 1", "2 s"}),
    scene("joint_body", {"/joints/0/a is \"dor\"", "did you mean \"door\"?"}),
    scene("joint_kinds", {"/joints/0 has 2 kinds of joint", "exactly one of ball, hinge"}),
    scene("self_joint", {"/joints/0 joins a body with itself"}),
    scene("zero_axis", {"/joints/0/axis is [0, 0, 0]", "direction"}),
};

const std::vector<Broken> kVehicles{
    car("negative_mass", {"negative_mass.car.json:3:23: /chassis/mass is -5", "in [0.001, 1e+09] kg"}),
    car("cyclic_extends", {"cyclic_extends.car.json:2:14: /extends", "must not lead back"}),
    car("wheel_radius", {"wheel_radius.car.json:4:", "/wheels/0/radius is -0.3", "in [0.001, 1000] m"}),
    car("missing_wheels", {"missing_wheels.car.json:1:1: /wheels is missing"}),
    car("two_wheels", {"two_wheels.car.json:3:13: /wheels has 2", "3 or more"}),
    car("differential_type", {"/differential/type is \"lockd\"", "did you mean \"locked\"?"}),
};

const std::vector<Broken> kRagdolls{
    ragdoll("absent_bone", {"absent_bone.ragdoll.json:4:32: /parts/0/bone is \"hib\"", "did you mean \"hip\"?"}),
    ragdoll("absent_part", {"/joints/0/child is \"foot\"", "must be the name of one of the 2 parts"}),
    ragdoll("zero_mass", {"/parts/0/mass is 0", "kg"}),
    ragdoll("reversed_limit", {"/joints/0/hinge/limit/lower is 1.5", "at most \"upper\", 0.5"}),
};

Broken robot(const std::string& name, std::vector<std::string> says) {
    return {name, "inspect " + name + ".urdf", std::move(says)};
}

const std::vector<Broken> kRobots{
    robot("mass_abc", {"mass_abc.urdf", "abc"}),
    robot("loop", {"loop.urdf: 2 links do not hang on the root 'a'", "loop"}),
    robot("missing_link", {"missing_link.urdf:4: joint 'j': child link 'leg' does not exist", "must be one of"}),
    robot("mimic_nobody", {"mimic_nobody.urdf:4: joint 'j': mimic joint is 'knee'", "must be one of"}),
    robot("mimic_itself", {"mimic_itself.urdf:4: joint 'j': mimics itself", "must mimic another"}),
    robot("macro", {"macro.urdf:2: has <xacro:property>", "expand it first"}),
    robot("negative_mass", {"negative_mass.urdf:3: link 'b': mass value is -1", "must be at least 0 kg"}),
    robot("joint_type", {"joint_type.urdf:4: joint 'j': type is 'elastic'", "must be revolute"}),
    robot("no_limit", {"no_limit.urdf:4: joint 'j': has no <limit>"}),
    robot("twice", {"twice.urdf:5: link 'a' is there twice"}),
    robot("range", {"range.urdf:4: joint 'j': limit lower is 2, must be at most upper, 1"}),
    robot("no_axis", {"no_axis.urdf:4: joint 'j': axis xyz is zero, must have a direction"}),
    robot("two_numbers", {"two_numbers.urdf:4: joint 'j': origin xyz is '1 2', must be 3 numbers"}),
    robot("massless", {"massless.urdf: link 'b' moves but has no mass", "above 0 kg"}),
    robot("two_parents", {"two_parents.urdf:5: joint 'k': child link 'b' hangs on another joint already"}),
    robot("no_link", {"no_link.urdf:1: robot has no link, must have at least one"}),
    robot("safety", {"safety.urdf:4: joint 'j': safety_controller k_velocity is -1", "at least 0"}),
    robot("unclosed", {"unclosed.urdf", "is no XML"}),
    robot("box_size", {"box_size.urdf:3: link 'b': box size is 1 0 1, must be above 0 m"}),
    robot("cylinder", {"cylinder.urdf:3: link 'b': cylinder radius is 0, must be above 0 m"}),
    robot("damping", {"damping.urdf:4: joint 'j': dynamics damping is -3, must be at least 0 N m s/rad or N s/m"}),
    robot("effort", {"effort.urdf:4: joint 'j': limit effort is -5, must be at least 0 N m or N"}),
    robot("inertia", {"inertia.urdf:3: link 'b': inertia ixx is -1, must be at least 0 kg m2"}),
    robot("products", {"products.urdf:3: link 'b': inertia has the moments xx 1, yy 1, zz 1, xy 2, xz 0, yz 0, which "
                       "are below 0 about some axis, must be at least 0 about all"}),
    robot("second", {"second.urdf:4: has something beside its outermost element, must have nothing"}),
    robot("itself", {"itself.urdf: 1 links do not hang on the root 'a': their joints form a loop"}),
    robot("no_parent", {"no_parent.urdf:4: joint 'j': has no <parent>"}),
    robot("unnamed", {"unnamed.urdf:4: joint has no name"}),
};

Broken mjcf(const std::string& name, std::vector<std::string> says) {
    return {name, "inspect " + name + ".xml", std::move(says)};
}

const std::vector<Broken> kMjcf{
    mjcf("actuator_joint", {"actuator_joint.xml:9: motor: joint is 'knee', must be the name of a joint"}),
    mjcf("body_twice", {"body_twice.xml:6: body 'a': is there twice"}),
    mjcf("class_absent", {"class_absent.xml:4: class 'foot' does not exist, must be one of the default classes"}),
    mjcf("equality_joint", {"equality_joint.xml:9: joint: joint2 is 'knee', must be the name of a joint"}),
    mjcf("free_twice", {"free_twice.xml:6: freejoint: is free, must be the only joint of a body of the world"}),
    mjcf("geom_number", {"geom_number.xml:5: geom: size is 'big', must be 1 to 3 numbers"}),
    mjcf("geom_size", {"geom_size.xml:4: geom: size is '0.1 -0.2 0.1', must be above 0 m"}),
    mjcf("geom_type",
         {"geom_type.xml:4: geom: type is 'torus', must be sphere, capsule, box, cylinder, ellipsoid, plane or mesh"}),
    mjcf("include_itself", {"include_itself.xml:2: include file is 'include_itself.xml', must be one of at most 64 "
                            "files that are included once"}),
    mjcf("include_outside",
         {"include_outside.xml:2: include file is '../../README.md', must be a file in the folder of the description"}),
    mjcf("inertial_mass", {"inertial_mass.xml:5: inertial: mass is '-1', must be at least 0 kg"}),
    mjcf("joint_axis", {"joint_axis.xml:5: joint 'j': axis is '0 0 0', must be a direction"}),
    mjcf("joint_kind", {"joint_kind.xml:5: joint 'j': type is 'spiral', must be free, ball, hinge or slide"}),
    mjcf("joint_limited", {"joint_limited.xml:5: joint 'j': is limited, must have a range"}),
    mjcf("joint_range", {"joint_range.xml:5: joint 'j': range is '40 -40', must be two numbers that rise"}),
    mjcf("joint_twice", {"joint_twice.xml:8: joint 'j': is there twice"}),
    mjcf("keyframe", {"keyframe.xml:9: key 'up': qpos is '0 1 2', must be 1 number"}),
    mjcf("mesh_absent", {"mesh_absent.xml:4: geom: mesh is 'cup', must be the name of a mesh of <asset>"}),
    mjcf("moments", {"moments.xml:5: inertial: moments are below 0, must be at least 0 kg m²"}),
    mjcf("second", {"second.xml:4: has something beside its outermost element, must have nothing"}),
    mjcf("tendon_empty", {"tendon_empty.xml:9: fixed 't': has 0 joints, must have 1 to 4"}),
    mjcf("tendon_joint", {"tendon_joint.xml:10: joint: joint is 'knee', must be the name of a joint"}),
    mjcf("zero_quaternion", {"zero_quaternion.xml:4: geom: quat is '0 0 0 0', must be a rotation w x y z"}),
};

const std::vector<Broken> kModels{
    {"empty_mesh", "inspect empty_mesh.obj", {"empty_mesh.obj"}},
    {"flat_bvh", "inspect flat.bvh", {"flat.bvh: has no triangles, and is no body: nothing is skinned or moves"}},
    {"syntax", "inspect syntax.gltf", {"syntax.gltf:3:14: is not JSON"}},
    {"outside", "inspect outside.gltf", {"outside.gltf: refers to '", "README.md', must refer to files in its folder"}},
    {"giant_off", "inspect giant.off", {"giant.off: the file needs more than 4 GiB of memory to import"}},
    {"giant_ply", "inspect giant.ply", {"giant.ply: the file needs more than 4 GiB of memory to import"}},
    {"picture", "inspect picture.fbx", {"picture.fbx", "it looks like a PNG picture"}},
    {"blend", "inspect blend.fbx", {"blend.fbx", "it looks like Blender's own format"}},
    {"words", "inspect words.stl", {"words.stl"}},
    {"line", "inspect line.obj", {"line.obj", "has no triangles, and is no body: nothing is skinned"}},
    {"index", "inspect index.obj", {"index.obj"}},
    {"not_a_number", "inspect nan.obj", {"nan.obj"}},
    {"hierarchy", "inspect hierarchy.bvh", {"hierarchy.bvh"}},
    {"garbage", "inspect garbage.glb", {"garbage.glb"}},
    {"truncated_gltf", "inspect truncated.gltf", {"truncated.gltf"}},
    {"no_bind_matrices",
     "inspect no_bind_matrices.gltf",
     {"no_bind_matrices.gltf: /skins/0 has no inverseBindMatrices, must have them"}},
    {"weights_of_zero",
     "inspect weights_of_zero.gltf",
     {"weights_of_zero.gltf: mesh 'meshes[0]' has 2 bones, but no weight of its vertices is a number above zero"}},
    {"flat_bind_matrix",
     "inspect flat_bind_matrix.gltf",
     {"flat_bind_matrix.gltf: bone 'a' has a rest pose that is flat, must have an inverse"}},
    {"required_extension",
     "inspect required_extension.gltf",
     {"/extensionsRequired/0 is 'EXT_meshopt_compression', which is not read"}},
    {"no_such_file", "inspect no_such_file.fbx", {"no_such_file.fbx"}},
};

/// A glTF file with physics.
Broken physics(const std::string& name, std::vector<std::string> says) {
    return {name, "inspect physics_" + name + ".gltf", std::move(says)};
}

const std::vector<Broken> kPhysics{
    physics("axes", {"gltf:2:179: /extensions/KHR_physics_rigid_bodies/physicsJoints/0/limits/0/linearAxes/1 is 5",
                     "an integer in [0, 2]"}),
    physics("friction", {"/physicsMaterials/0/staticFriction is -1", "a number in [0, 10]"}),
    physics("inertia", {"gltf:4:", "/nodes/1/", "/motion/inertiaDiagonal/1 is -1", "in [0, 1e+12] kg m2"}),
    physics("joint", {"gltf:5:", "/nodes/2/", "/joint/joint is 3", "must be one of 1 joints of the file"}),
    physics("loop", {"gltf:3:", "/nodes/0/children lead back to node 0", "must be below it"}),
    physics("mass", {"gltf:4:", "/nodes/1/", "/motion/mass is -2", "in [0, 1e+09] kg"}),
    physics("mesh", {"/meshes/4 is not there", "must be one of 0 meshes"}),
    physics("node", {"gltf:5:", "/nodes/2/", "/joint/connectedNode is 9", "must be one of 3 nodes"}),
    physics("radius", {"gltf:2:", "/KHR_implicit_shapes/shapes/0/sphere/radius is 0", "in [0.0001, 100000] m"}),
    physics("range", {"gltf:2:", "/physicsJoints/0/limits/1/min is 1", "must be at most \"max\", -1"}),
    physics("shape", {"gltf:4:", "/nodes/1/", "/collider/geometry/shape is 7", "must be one of 1 shapes"}),
    physics("shape_kind", {"gltf:2:", "/shapes/0/type is \"cone\"", "\"sphere\", \"box\", \"capsule\""}),
};

const std::vector<Broken> kUsage{
    {"unknown_command",
     "fly",
     {"\"fly\" is unknown", "must be one of list, run, serve, drive, ragdoll, fit, cook, inspect"}},
    {"unknown_option_of_none", "--fast", {"\"--fast\" is unknown"}},
    {"two_words", "list crash", {"crash"}},
    {"unknown_scene", "run towr", {"towr: no such scene", "did you mean \"tower\"?"}},
    {"unknown_option", "run tower --fast", {"--fast"}},
    {"bad_number", "run tower --steps many", {"--steps", "many"}},
    {"bad_lanes", "run tower --lanes 5", {"--lanes", "5"}},
    {"setting_without_value", "run tower --set sleeping", {"--set", "must be key=value"}},
    {"unknown_setting", "run tower --set gravty=[0,0,0]", {"--set gravty", "/gravty is unknown"}},
    {"setting_of_wrong_type",
     "run tower --set substeps=many",
     {"/settings/substeps is \"many\"", "an integer in [1, 64]"}},
    {"setting_out_of_range", "run tower --set settings.substeps=0", {"/settings/substeps is 0", "in [1, 64]"}},
    {"no_state", "run tower --restore no_such.bin", {"no_such.bin: no such file"}},
    {"state_of_something_else", "run tower --restore mass_abc.urdf", {"mass_abc.urdf: is no state of this scene"}},
};

std::string nameOf(const testing::TestParamInfo<Broken>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Text, BrokenFile, testing::ValuesIn(kText), nameOf);
INSTANTIATE_TEST_SUITE_P(Scene, BrokenFile, testing::ValuesIn(kScenes), nameOf);
INSTANTIATE_TEST_SUITE_P(Vehicle, BrokenFile, testing::ValuesIn(kVehicles), nameOf);
INSTANTIATE_TEST_SUITE_P(Ragdoll, BrokenFile, testing::ValuesIn(kRagdolls), nameOf);
INSTANTIATE_TEST_SUITE_P(Robot, BrokenFile, testing::ValuesIn(kRobots), nameOf);
INSTANTIATE_TEST_SUITE_P(Physics, BrokenFile, testing::ValuesIn(kPhysics), nameOf);
INSTANTIATE_TEST_SUITE_P(Mjcf, BrokenFile, testing::ValuesIn(kMjcf), nameOf);
INSTANTIATE_TEST_SUITE_P(Model, BrokenFile, testing::ValuesIn(kModels), nameOf);
INSTANTIATE_TEST_SUITE_P(Usage, BrokenFile, testing::ValuesIn(kUsage), nameOf);

TEST(Usage, WithoutACommandIsTheHelp) {
    const ProgramResult result = ragtop("");
    EXPECT_EQ(result.exitCode, 2);
    for (const char* text : {"Usage: ragtop", "--help", "--version", "list", "run", "serve", "inspect"}) {
        EXPECT_THAT(result.errors, HasSubstr(text));
    }
}

}  // namespace
