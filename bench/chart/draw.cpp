#include "draw.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "analysis.h"
#include "csv.h"
#include "findings.h"
#include "scenes.h"
#include "variants.h"

namespace ragtop::chart {
namespace {

using Json = nlohmann::ordered_json;

const std::filesystem::path kFolder = RAGTOP_CHART_PAGE;

Json scenesOf(const Points& points) {
    Json scenes = Json::array();
    for (const ChartScene& scene : allScenes())
        if (std::ranges::find(points, scene.name, &Point::scene) != points.end())
            scenes.push_back({{"name", scene.name},
                              {"title", scene.title},
                              {"kind", nameOf(scene.reference)},
                              {"how", scene.how},
                              {"floor", scene.floor},
                              {"failsFrom", scene.failsFrom},
                              {"inUnits", scene.scale > 0}});
    return scenes;
}

Json variantsOf(const Points& points) {
    Json variants = Json::array();
    for (const Variant& variant : allVariants())
        if (std::ranges::find(points, variant.name, &Point::variant) != points.end())
            variants.push_back({{"engine", variant.engine},
                                {"name", variant.name},
                                {"version", variant.version},
                                {"what", variant.what}});
    return variants;
}

/// As many digits as can be seen; what is no number becomes null.
Json shortened(double value) { return std::isfinite(value) ? Json(std::stod(fmt::format("{:.6g}", value))) : Json(); }

/// Points by columns, which take a third of the room; of texts each once.
class Columns {
public:
    void add(const Point& p) {
        text("scene", p.scene);
        text("engine", p.engine);
        text("variant", p.variant);
        text("version", p.version);
        text("quantity", p.quantity);
        text("unit", p.unit);
        text("outcome", p.outcome == Outcome::measured ? "measured" : "failed");
        text("reason", p.reason);
        text("command", p.command);
        put("step", p.setting.step);
        put("substeps", p.setting.substeps);
        put("iterations", p.setting.iterations);
        put("standard", p.isDefault);
        put("alone", p.alone);
        put("failedAt", shortened(p.failedAt));
        put("value", shortened(p.value));
        put("reference", shortened(p.reference));
        put("error", shortened(p.error));
        put("errorLow", shortened(p.errorLow));
        put("errorHigh", shortened(p.errorHigh));
        put("consistency", shortened(p.selfConsistency));
        put("contacts", shortened(p.contacts));
        put("passes", shortened(p.passes));
        put("ms", shortened(p.cpuMs));
        put("msLow", shortened(p.cpuMsLow));
        put("msHigh", shortened(p.cpuMsHigh));
    }
    Json all() const { return {{"numbers", numbers_}, {"texts", texts_}}; }

private:
    void put(const char* name, const Json& value) { numbers_[name].push_back(value); }
    void text(const char* name, const std::string& value) {
        Json& column = texts_[name];
        const auto [at, isNew] = known_[name].try_emplace(value, known_[name].size());
        if (isNew) column["each"].push_back(value);
        column["at"].push_back(at->second);
    }
    Json numbers_ = Json::object(), texts_ = Json::object();
    std::map<std::string, std::map<std::string, std::size_t>> known_;
};

Json frontsOf(const Points& points, const std::vector<Json>& places) {
    Json fronts = Json::array();
    for (const Front& front : chart::frontsOf(points)) {
        Json indices = Json::array();
        for (const Point* point : front.points)
            indices.push_back(places[static_cast<std::size_t>(point - points.data())]);
        fronts.push_back({{"scene", front.scene}, {"engine", front.engine}, {"points", indices}});
    }
    return fronts;
}

Json cheapestOfAll(const CheapestTable& table, const std::vector<Json>& places, const Points& points) {
    Json rows = Json::array();
    for (const Cheapest& row : table.rows) {
        Json cells = Json::array();
        for (const Point* point : row.perEngine)
            cells.push_back(point ? places[static_cast<std::size_t>(point - points.data())] : Json());
        rows.push_back({{"scene", row.scene}, {"error", row.error}, {"points", cells}});
    }
    return {{"engines", table.engines}, {"rows", rows}};
}

Json profilesOfAll(const CheapestTable& table) {
    Json profiles = Json::array();
    for (const Profile& profile : profilesOf(table)) {
        Json steps = Json::array();
        for (const Profile::Step& step : profile.steps) steps.push_back({step.ratio, step.share});
        profiles.push_back({{"engine", profile.engine}, {"steps", steps}});
    }
    return profiles;
}

std::string readAll(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw std::runtime_error(file.string() + ": is not there; scripts/page.sh build makes it");
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string shortMs(double ms) { return fmt::format("{:.3g}", ms); }

std::string titleOf(const std::string& scene) {
    const auto at = std::ranges::find(allScenes(), scene, &ChartScene::name);
    return at == allScenes().end() ? scene : at->title;
}

std::string settingOf(const Point& point) {
    std::string text = fmt::format("{}, {} Hz", point.variant, std::lround(1 / point.setting.step));
    if (point.setting.substeps != 1) text += fmt::format(" × {}", point.setting.substeps);
    if (point.setting.iterations > 0) text += fmt::format(", {} it.", point.setting.iterations);
    return text;
}

}  // namespace

std::string documentOf(const Points& points) {
    Columns drawn;
    std::vector<Json> places;
    std::size_t count = 0;
    for (const Point& point : points) {
        const bool takesPart = point.outcome != Outcome::unsupported;
        places.push_back(takesPart ? Json(count++) : Json());
        if (takesPart) drawn.add(point);
    }
    const CheapestTable table = cheapestOf(points);
    const Json document = {{"scenes", scenesOf(points)},
                           {"variants", variantsOf(points)},
                           {"points", drawn.all()},
                           {"fronts", frontsOf(points, places)},
                           {"cheapest", cheapestOfAll(table, places, points)},
                           {"profiles", profilesOfAll(table)}};
    return document.dump();
}

void drawPage(const Points& points, const std::filesystem::path& file) {
    std::string page = readAll(kFolder / "chart.html");
    constexpr std::string_view kPlace = "\"the data\"";
    const std::size_t at = page.find(kPlace);
    if (at == std::string::npos)
        throw std::runtime_error((kFolder / "chart.html").string() + ": has no place for data");
    std::string data = documentOf(points);
    // Nothing in it may end the script element that it stands in.
    for (std::size_t i = 0; (i = data.find("</", i)) != std::string::npos; i += 3) data.replace(i, 2, "<\\/");
    page.replace(at, kPlace.size(), data);
    writeWhole(file, page);
}

std::string drawPicture(const std::filesystem::path& page, const std::filesystem::path& picture) {
    const std::string script = (kFolder / "chart_svg.cjs").string();
    const pid_t process = ::fork();
    if (process < 0) return "no process for node";
    if (process == 0) {
        ::execlp("node", "node", script.c_str(), page.c_str(), picture.c_str(), nullptr);
        std::_Exit(127);
    }
    int status = 0;
    ::waitpid(process, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127) return "node is not there";
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "" : script + " has failed";
}

std::string lossTable(const Points& points) {
    std::string text;
    for (const Dominance& each : dominancesOf(points))
        text += fmt::format(
            "- Of {} scenes with {}, Ragtop's front dominates in {}, and takes at most 1.5 times as long in {}; in {} "
            "where "
            "answers count that are a tenth off and more.\n",
            each.scenes, each.engine, each.dominated, each.nearly, each.dominatedOverall);
    text += "\n| Scene | Engine | Error | Engine, ms/s | Ragtop, ms/s | Ratio | Why |\n|---|---|---|---|---|---|---|\n";
    for (const Loss& loss : lossesOf(points)) {
        const bool reached = std::isfinite(loss.ratio);
        text += fmt::format("| {} | {} | {:.2g} | {} | {} | {} | {} |\n", titleOf(loss.scene), loss.engine, loss.error,
                            shortMs(loss.peerMs), reached ? shortMs(loss.ragtopMs) : "never",
                            reached ? fmt::format("{:.2f}", loss.ratio) : "–", reasonOf(loss.scene, loss.engine));
    }
    return text;
}

std::string cheapestTable(const Points& points) {
    const CheapestTable table = cheapestOf(points);
    std::string text = "| Scene | Error |", rule = "\n|---|---|";
    for (const std::string& engine : table.engines) {
        text += fmt::format(" {} |", engine);
        rule += "---|";
    }
    text += rule + "\n";
    for (const Cheapest& row : table.rows) {
        text += fmt::format("| {} | {:g} |", titleOf(row.scene), row.error);
        for (const Point* point : row.perEngine)
            text += point ? fmt::format(" {}: {} |", shortMs(point->cpuMs), settingOf(*point)) : std::string(" – |");
        text += "\n";
    }
    return text;
}

std::string sceneTable() {
    std::string text =
        "| Scene | Name | Suite | Reference | Kind | Error of | Floor | Fails from "
        "|\n|---|---|---|---|---|---|---|---|\n";
    for (const ChartScene& scene : allScenes())
        text += fmt::format("| {} | `{}` | {}/{} | {} | {} | {} | {:g} | {:g} |\n", scene.title, scene.name,
                            scene.family, scene.test, scene.how, nameOf(scene.reference),
                            fmt::join(scene.quantities, ", "), scene.floor, scene.failsFrom);
    return text;
}

}  // namespace ragtop::chart
