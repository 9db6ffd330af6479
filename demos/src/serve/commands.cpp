#include "commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

namespace ragtop::live {
namespace {

constexpr float kFarthest = 1e6f;    ///< m, of positions
constexpr int kDeepest = 8;          ///< nesting of a message
constexpr double kMostSteps = 9e15;  ///< whole numbers up to here are exact

class Wrong : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

std::string shown(const Json& value) {
    std::string line = text(value);
    if (line.size() <= 60) return line;
    std::size_t end = 57;
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xc0) == 0x80) --end;
    return line.substr(0, end) + "...";
}

/// The members of a message; each must be asked for once.
class Members {
public:
    explicit Members(const Json& message) : message_(message) {}

    bool has(const char* key) {
        known_.insert(key);
        return message_.contains(key);
    }

    float number(const char* key, float low, float high) {
        return within(key, at(key, fmt::format("a number in [{}, {}]", low, high)), low, high);
    }
    std::optional<float> numberIfAny(const char* key, float low, float high) {
        return has(key) ? std::optional(number(key, low, high)) : std::nullopt;
    }

    std::int64_t integer(const char* key, std::int64_t low, std::int64_t high) {
        const std::string allowed = fmt::format("an integer in [{}, {}]", low, high);
        const Json& value = at(key, allowed);
        const bool isLarge = value.is_number_unsigned() && value.get<std::uint64_t>() > std::uint64_t{1} << 62;
        if (!value.is_number_integer() || isLarge) fail(key, value, allowed);
        const auto found = value.get<std::int64_t>();
        if (found < low || found > high) fail(key, value, allowed);
        return found;
    }

    Vec3 vector(const char* key) {
        const std::string allowed = fmt::format("three numbers in [-{0}, {0}]", kFarthest);
        const Json& value = at(key, allowed);
        if (!value.is_array() || value.size() != 3) fail(key, value, allowed);
        Vec3 v;
        for (int i = 0; i < 3; ++i) v[i] = within(key, value[static_cast<std::size_t>(i)], -kFarthest, kFarthest);
        return v;
    }

    bool flag(const char* key) {
        const Json& value = at(key, "true or false");
        if (!value.is_boolean()) fail(key, value, "true or false");
        return value.get<bool>();
    }

    std::string name(const char* key) {
        const Json& value = at(key, "a text");
        if (!value.is_string()) fail(key, value, "a text");
        return value.get<std::string>();
    }

    const Json& at(const char* key, const std::string& allowed) {
        if (!has(key)) throw Wrong(fmt::format("{} is missing, must be {}", key, allowed));
        return message_[key];
    }

    [[noreturn]] static void fail(const char* key, const Json& value, const std::string& allowed) {
        throw Wrong(fmt::format("{} is {}, must be {}", key, shown(value), allowed));
    }

    void requireNoOthers() const {
        for (const auto& item : message_.items()) {
            if (known_.contains(item.key())) continue;
            std::vector<std::string> names(known_.begin(), known_.end());
            throw Wrong(fmt::format("{} is unknown, must be one of {}", shown(item.key()), fmt::join(names, ", ")));
        }
    }

private:
    static float within(const char* key, const Json& value, float low, float high) {
        const std::string allowed = fmt::format("a number in [{}, {}]", low, high);
        if (!value.is_number()) fail(key, value, allowed);
        const double found = value.get<double>();
        if (!(found >= static_cast<double>(low) && found <= static_cast<double>(high))) fail(key, value, allowed);
        return static_cast<float>(found);
    }

    const Json& message_;
    std::set<std::string> known_{"do", "id"};
};

template <class T>
Command readPlain(Members&) {
    return T{};
}

Command readStep(Members& in) { return StepCommand{static_cast<int>(in.integer("count", -600, 600))}; }
Command readSeek(Members& in) {
    return SeekCommand{static_cast<std::uint64_t>(in.integer("step", 0, static_cast<std::int64_t>(kMostSteps)))};
}
Command readSpeed(Members& in) { return SpeedCommand{static_cast<double>(in.number("factor", 0.01f, 4))}; }
Command readLoad(Members& in) { return LoadCommand{in.name("scene")}; }

Command readShow(Members& in) {
    ShowCommand show;
    for (const std::string& option : showNames()) {
        if (in.has(option.c_str())) show.options.emplace_back(option, in.flag(option.c_str()));
    }
    return show;
}

std::uint32_t readNode(Members& in) { return static_cast<std::uint32_t>(in.integer("node", 0, 0xffffffff)); }
std::size_t readVehicle(Members& in) { return static_cast<std::size_t>(in.integer("vehicle", 0, 0xffffffff)); }

Command readGrab(Members& in) {
    const std::uint32_t node = readNode(in);
    const Vec3 point = in.vector("point");
    return GrabCommand{node, point, in.vector("target")};
}
Command readDrag(Members& in) { return DragCommand{in.vector("target")}; }

Command readShoot(Members& in) {
    ShootCommand shoot;
    shoot.origin = in.vector("origin");
    shoot.direction = in.vector("direction");
    shoot.speed = in.numberIfAny("speed", 0, 200).value_or(shoot.speed);
    shoot.radius = in.numberIfAny("radius", 0.02f, 2).value_or(shoot.radius);
    return shoot;
}

Command readDrive(Members& in) {
    DriveCommand drive;
    drive.vehicle = readVehicle(in);
    drive.throttle = in.numberIfAny("throttle", 0, 1);
    drive.brake = in.numberIfAny("brake", 0, 1);
    drive.steer = in.numberIfAny("steer", -1, 1);
    drive.handbrake = in.numberIfAny("handbrake", 0, 1);
    if (in.has("gear")) {
        const bool automatic = in.at("gear", "").is_null();
        drive.gear = automatic ? std::optional<int>() : static_cast<int>(in.integer("gear", -1, 20));
    }
    return drive;
}
Command readResetVehicle(Members& in) { return ResetVehicleCommand{readVehicle(in)}; }

Command readPick(Members& in) {
    if (in.at("node", "the number of a node or null").is_null()) return PickCommand{};
    return PickCommand{readNode(in)};
}

TuneValue readTuneValue(Members& in) {
    static constexpr const char* kAllowed = "a number, true or false, three numbers, a text or null";
    const Json& value = in.at("value", kAllowed);
    if (value.is_null()) return {};
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number()) return value.get<double>();
    if (value.is_string()) return value.get<std::string>();
    const bool isVector = value.is_array() && value.size() == 3 &&
                          std::all_of(value.begin(), value.end(), [](const Json& one) { return one.is_number(); });
    if (!isVector) Members::fail("value", value, kAllowed);
    return DVec3(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
}

Command readTune(Members& in) {
    std::string path = in.name("path");
    return TuneCommand{std::move(path), readTuneValue(in)};
}
Command readUntune(Members& in) { return UntuneCommand{in.name("path")}; }

/// A name that is safe as part of a file name.
std::string readFileName(Members& in) {
    std::string name = in.name("name");
    const bool isPlain = std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    });
    if (name.empty() || name.size() > 64 || !isPlain) Members::fail("name", name, "1 to 64 letters, digits, _ and -");
    return name;
}
Command readSaveTuning(Members& in) {
    SaveTuningCommand save;
    if (in.has("name")) save.name = readFileName(in);
    return save;
}
Command readLoadTuning(Members& in) { return LoadTuningCommand{readFileName(in)}; }

struct Verb {
    const char* name;
    Command (*read)(Members&);
};
constexpr std::array kVerbs{
    Verb{"play", readPlain<PlayCommand>},
    Verb{"pause", readPlain<PauseCommand>},
    Verb{"step", readStep},
    Verb{"seek", readSeek},
    Verb{"reset", readPlain<RestartCommand>},
    Verb{"speed", readSpeed},
    Verb{"load", readLoad},
    Verb{"scenes", readPlain<ScenesCommand>},
    Verb{"show", readShow},
    Verb{"grab", readGrab},
    Verb{"drag", readDrag},
    Verb{"release", readPlain<ReleaseCommand>},
    Verb{"shoot", readShoot},
    Verb{"drive", readDrive},
    Verb{"resetVehicle", readResetVehicle},
    Verb{"pick", readPick},
    Verb{"tune", readTune},
    Verb{"untune", readUntune},
    Verb{"saveTuning", readSaveTuning},
    Verb{"loadTuning", readLoadTuning},
    Verb{"hash", readPlain<HashCommand>},
};

void readCommand(const Json& json, Message& message) {
    Members in(json);
    std::vector<const char*> names;
    for (const Verb& verb : kVerbs) names.push_back(verb.name);
    const std::string allowed = fmt::format("one of {}", fmt::join(names, ", "));
    const Json& verb = in.at("do", allowed);
    const auto known = std::find_if(kVerbs.begin(), kVerbs.end(), [&](const Verb& v) { return verb == v.name; });
    if (known == kVerbs.end()) Members::fail("do", verb, allowed);
    message.verb = known->name;
    Command command = known->read(in);
    in.requireNoOthers();
    message.command = std::move(command);
}

/// Refuses what is nested deeply, and keys that occur twice, of which a parser would keep either.
class Strict {
public:
    bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
        if (depth > kDeepest) throw Wrong(fmt::format("nests deeper than {} levels, the most allowed", kDeepest));
        if (event == Json::parse_event_t::object_start) keys_.emplace_back();
        if (event == Json::parse_event_t::object_end) keys_.pop_back();
        if (event == Json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second) {
            throw Wrong(shown(parsed) + " occurs twice, must occur once");
        }
        return true;
    }

private:
    std::vector<std::set<std::string>> keys_;
};

Json parse(std::string_view text) {
    try {
        return Json::parse(text, Strict());
    } catch (const Json::exception& error) {
        throw Wrong(std::string("is not JSON: ") + error.what());
    }
}

}  // namespace

const std::vector<std::string>& showNames() {
    static const std::vector<std::string> names{"contacts", "joints", "bounds",   "centers",
                                                "islands",  "wheels", "skeleton", "shapes"};
    return names;
}

std::string Message::explained(const std::string& wrong) const { return verb.empty() ? wrong : verb + ": " + wrong; }

Message readMessage(std::string_view text) {
    Message message;
    try {
        const Json json = parse(text);
        if (!json.is_object()) throw Wrong("is " + shown(json) + ", must be an object");
        if (json.contains("id")) message.id = Members(json).integer("id", -(1ll << 53), 1ll << 53);
        readCommand(json, message);
    } catch (const Wrong& error) {
        message.error = message.explained(error.what());
    }
    return message;
}

}  // namespace ragtop::live
