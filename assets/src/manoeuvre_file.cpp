#include <algorithm>
#include <system_error>

#include "described_file.h"
#include "ragtop/data_folder.h"
#include "ragtop/manoeuvre.h"

namespace ragtop {

template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackKerb*) {
    visit(Tunable{"height", "m", 0, 2, "of the step"}, self.height);
    visit(Tunable{"at", "m", -1000, 1000, "along z"}, self.at);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackWall*) {
    visit(Tunable{"height", "m", 0.01, 100, "of the wall"}, self.height);
    visit(Tunable{"at", "m", -1000, 1000, "along z, of its face"}, self.at);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackRubble*) {
    visit(Tunable{"mass", "kg", 0.01, 1e5, "of each cube"}, self.mass);
    visit(Tunable{"size", "m", 0.01, 2, "of an edge"}, self.size);
    visit(Tunable{"from", "m", -1000, 1000, "along z"}, self.from);
    visit(Tunable{"to", "m", -1000, 1000, "along z"}, self.to);
    visit(Tunable{"count", "1", 1, 5000, "of cubes"}, self.count);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackLoop*) {
    visit(Tunable{"radius", "m", 2, 100, "of its circle"}, self.radius);
    visit(Tunable{"at", "m", 0, 1900, "along the way, of its lowest point"}, self.at);
    visit(Tunable{"aside", "m", 0, 50, "to the left, of its end from its beginning"}, self.aside);
    visit(Tunable{"width", "m", 1, 50, "of its track"}, self.width);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackGround*) {
    visit(Tunable{"friction", "1", 0, 10, "of the ground"}, self.friction);
    visit(Tunable{"rightFriction", "1", 0, 10, "right of x = 0; absent: the same"}, self.rightFriction);
    visit(Tunable{"slope", "1", -2, 2, "rise over run along z"}, self.slope);
    visit(Tunable{"tiles", "m", 0.2, 1000, "length of the tiles that it is laid of; absent: one piece"}, self.tiles);
    visit(Tunable{"kerb", "", 0, 0, "a step up across the way"}, self.kerb);
    visit(Tunable{"wall", "", 0, 0, "across the way"}, self.wall);
    visit(Tunable{"rubble", "", 0, 0, "loose cubes on the way"}, self.rubble);
    visit(Tunable{"loop", "", 0, 0, "a looping on the way"}, self.loop);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackTrailer*) {
    visit(Tunable{"mass", "kg", 1, 1e6, "of the whole trailer"}, self.mass);
    visit(Tunable{"length", "m", 2, 50, "from the hitch to the middle between the axles"}, self.length);
    visit(Tunable{"ahead", "m", -0.2, 0.2, "of the centre of mass before that middle"}, self.ahead);
    visit(Tunable{"yawInertia", "kg m²", 0.1, 1e9, "about the centre of mass"}, self.yawInertia);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackStart*) {
    visit(Tunable{"height", "m", 0, 100, "above where the car stands"}, self.height);
    visit(Tunable{"pitch", "rad", -kWholeTurn, kWholeTurn, "nose down"}, self.pitch);
    visit(Tunable{"heading", "rad", -kWholeTurn, kWholeTurn, "to the left"}, self.heading);
    visit(Tunable{"roll", "rad", -kWholeTurn, kWholeTurn, "to the right"}, self.roll);
    visit(Tunable{"speed", "m/s", -100, 150, "forward, wheels rolling"}, self.speed);
    visit(Tunable{"sideSpeed", "m/s", -100, 100, "to the left"}, self.sideSpeed);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackInput*) {
    visit(Tunable{"time", "s", 0, 1e4, "from which on it holds"}, self.time);
    visit(Tunable{"throttle", "1", 0, 1, "pedal"}, self.throttle);
    visit(Tunable{"brake", "1", 0, 1, "pedal"}, self.brake);
    visit(Tunable{"handbrake", "1", 0, 1, "lever"}, self.handbrake);
    visit(Tunable{"clutch", "1", 0, 1, "pedal; 0: automatic"}, self.clutch);
    visit(Tunable{"wheelAngle", "rad", -1.5, 1.5, "of a wheel in the middle of the front axle, to the left"},
          self.wheelAngle);
    visit(Tunable{"gear", "", -1, 20, "absent: the gearbox decides"}, self.gear);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackCruise*) {
    visit(Tunable{"speed", "m/s", 0, 150, "that the driver keeps"}, self.speed);
    visit(Tunable{"until", "s", 0, 1e6, "when the driver leaves it to the input"}, self.until);
    visit(Tunable{"radius", "m", 3, 1e4, "of a circle to the left; absent: the line or the input steers"}, self.radius);
    visit(Tunable{"line", "m", -1e5, 1e5, "points of a smooth line; absent: the input steers"}, self.line);
    visit(Tunable{"closed", "", 0, 1, "the line is a lap"}, self.closed);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const TrackMeasurement*) {
    visit(Tunable{"name", "", 0, 0, "of the value"}, self.name);
    visit(Tunable{"channel", "", 0, 0, "what is looked at"}, self.channel);
    visit(Tunable{"take", "", 0, 0, "what is taken of it"}, self.take);
    visit(Tunable{"from", "s", 0, 1e6, "first time"}, self.from);
    visit(Tunable{"to", "s", 0, 1e6, "last time"}, self.to);
    visit(Tunable{"level", "", -1e9, 1e9, "in the channel's unit"}, self.level);
    visit(Tunable{"law", "", 0, 0, "a reference that follows from the car"}, self.law);
    visit(Tunable{"reference", "", -1e9, 1e9, "instead of a law"}, self.reference);
    visit(Tunable{"tolerance", "1", 0, 10, "of the reference"}, self.tolerance);
    visit(Tunable{"least", "", -1e9, 1e9, "below which the value fails"}, self.least);
    visit(Tunable{"greatest", "", -1e9, 1e9, "above which it fails"}, self.greatest);
}
template <class Visitor, class Self>
static void describe(Visitor& visit, Self& self, const Manoeuvre*) {
    visit(Tunable{"name", "", 0, 0, "absent: the file's"}, self.name);
    visit(Tunable{"description", "", 0, 0, "in a line"}, self.description);
    visit(Tunable{"duration", "s", 0.1, 1e4, "of the whole"}, self.duration);
    visit(Tunable{"ground", "", 0, 0, "what is driven on"}, self.ground);
    visit(Tunable{"start", "", 0, 0, "how the car is put there"}, self.start);
    visit(Tunable{"trailer", "", 0, 0, "what the car pulls; absent: nothing"}, self.trailer);
    visit(Tunable{"input", "", 0, 0, "what the driver does, by rising time"}, self.input);
    visit(Tunable{"cruise", "", 0, 0, "a driver who keeps a speed"}, self.cruise);
    visit(Tunable{"sleeping", "", 0, 1, "the car may fall asleep"}, self.sleeping);
    visit(Tunable{"leastLevel", "", 0, 0, "of the car's model, that has what is measured"}, self.leastLevel);
    visit(Tunable{"plot", "", 0, 0, "channels"}, self.plot);
    visit(Tunable{"measure", "", 0, 0, "values and when they are good"}, self.measure);
}
static constexpr std::array<const char*, 2> requiredFields(const TrackMeasurement*) { return {"name", "channel"}; }
static constexpr std::array<const char*, 1> requiredFields(const Manoeuvre*) { return {"measure"}; }

std::string whyInvalid(const Manoeuvre& manoeuvre) {
    for (std::size_t i = 1; i < manoeuvre.input.size(); ++i) {
        if (manoeuvre.input[i].time > manoeuvre.input[i - 1].time) continue;
        return "/input/" + std::to_string(i) + "/time is not above that of the point before, must be";
    }
    if (manoeuvre.cruise && manoeuvre.cruise->line.size() == 1) return "/cruise/line has 1 point, must have 2 or more";
    if (manoeuvre.cruise && manoeuvre.cruise->radius && !manoeuvre.cruise->line.empty())
        return "/cruise/line is there beside a radius, must be one of them";
    if (manoeuvre.measure.empty()) return "/measure is empty, must have a value";
    for (std::size_t i = 0; i < manoeuvre.measure.size(); ++i) {
        const TrackMeasurement& one = manoeuvre.measure[i];
        const std::string at = "/measure/" + std::to_string(i);
        if (!(one.to > one.from)) return at + "/to is not above from, must be";
        if (!(one.from < manoeuvre.duration)) return at + "/from is not below the duration, must be";
        const bool ofLine = one.channel == TrackChannel::aside || one.channel == TrackChannel::laps;
        if (ofLine && !(manoeuvre.cruise && !manoeuvre.cruise->line.empty()))
            return at + "/channel is of a line, must be another where the cruise has none";
        const bool ofTrailer = one.channel == TrackChannel::hitchForce || one.channel == TrackChannel::articulation ||
                               one.law == TrackLaw::hitchPull || one.law == TrackLaw::hitchSwing;
        if (ofTrailer && !manoeuvre.trailer)
            return at + " is of a trailer, must be of something else where there is none";
        if (one.law == TrackLaw::hitchSwing && one.channel != TrackChannel::articulation)
            return at + "/law is hitchSwing, must be another where the channel is not articulation";
        if (one.law == TrackLaw::bicycleSteer && !(manoeuvre.cruise && manoeuvre.cruise->radius))
            return at + "/law is bicycleSteer, must be another where the cruise has no radius";
    }
    return {};
}

Manoeuvre loadManoeuvre(const std::filesystem::path& path) {
    const JsonDocument document = loadExtended(path);
    Faults faults(document);
    Manoeuvre manoeuvre = readDocument<Manoeuvre>(document, faults);
    faults.throwIfAny();
    if (manoeuvre.name.empty()) manoeuvre.name = path.stem().string();
    if (const std::string wrong = whyInvalid(manoeuvre); !wrong.empty()) failInvalid(document, wrong);
    return manoeuvre;
}

std::vector<std::string> shippedManoeuvres() {
    std::vector<std::string> names;
    std::error_code none;  // where there is no such folder
    for (const auto& entry : std::filesystem::directory_iterator(dataFolder() / "manoeuvres", none)) {
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    }
    std::ranges::sort(names);
    return names;
}

std::filesystem::path findManoeuvre(std::string_view nameOrPath) {
    const auto names = shippedManoeuvres();
    const std::string name(nameOrPath);
    // First, or a file of the same name would end a drive of all.
    if (std::ranges::find(names, name) != names.end()) return dataFolder() / "manoeuvres" / (name + ".json");
    std::error_code ignored;
    const std::filesystem::path path(nameOrPath);
    if (std::filesystem::is_regular_file(path, ignored)) return path;
    std::string message = name + ": no such manoeuvre, must be a file, all, or one of";
    for (const std::string& one : names) message += (&one == names.data() ? " " : ", ") + one;
    throw AssetError(message);
}

}  // namespace ragtop
