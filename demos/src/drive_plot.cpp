#include "drive_plot.h"

#include <fmt/format.h>

#include <algorithm>

namespace ragtop::demos {
namespace {

constexpr double kWidth = 640, kHeight = 200, kLeft = 70, kBottom = 30, kTop = 20;  ///< px, of a plot and its margins

std::string curve(const TrackRun& run, std::size_t channel, double top) {
    const auto value = [&](const auto& sample) { return sample[channel]; };
    double low = value(std::ranges::min(run.samples, {}, value)),
           high = value(std::ranges::max(run.samples, {}, value));
    if (!(high > low)) high = low + 1;
    const double end = std::max(run.samples.back()[0], 1e-9);
    const double right = kWidth - 10, base = top + kHeight - kBottom;
    // As many points as there are pixels.
    const std::size_t stride = std::max<std::size_t>(1, run.samples.size() / static_cast<std::size_t>(kWidth));
    std::string points;
    for (std::size_t i = 0; i < run.samples.size(); i += stride) {
        const double x = kLeft + run.samples[i][0] / end * (right - kLeft);
        const double y = base - (run.samples[i][channel] - low) / (high - low) * (base - top - kTop);
        points += fmt::format("{:.1f},{:.1f} ", x, y);
    }
    const TrackChannelInfo& info = kTrackChannels[channel];
    std::string text = fmt::format(
        "<path d=\"M{0} {1}V{2}H{3}\" fill=\"none\" stroke=\"#888\"/>\n"
        "<polyline points=\"{4}\" fill=\"none\" stroke=\"#06c\" stroke-width=\"1.5\"/>\n",
        kLeft, top + kTop, base, right, points);
    const auto label = [&](double x, double y, std::string_view anchor, const std::string& what) {
        text += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, what);
    };
    label(kLeft - 6, top + kTop + 4, "end", fmt::format("{:.4g}", high));
    label(kLeft - 6, base + 4, "end", fmt::format("{:.4g}", low));
    label(kLeft, top + kTop - 6, "start", fmt::format("{}, {}", info.name, info.unit));
    label(right, base + 16, "end", fmt::format("{:.4g} s", end));
    return text;
}

}  // namespace

std::string plotOf(const Manoeuvre& manoeuvre, const TrackRun& run) {
    const double height = kHeight * static_cast<double>(manoeuvre.plot.size());
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        kWidth, height);
    for (std::size_t i = 0; i < manoeuvre.plot.size(); ++i)
        svg += curve(run, static_cast<std::size_t>(manoeuvre.plot[i]), kHeight * static_cast<double>(i));
    return svg + "</svg>\n";
}

}  // namespace ragtop::demos
