#include "measure.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../stability/scenery.h"
#include "interval.h"

namespace ragtop::chart {
namespace {

using stability::Trial;

/// The clock may run ahead of the processor's time by so much before another process is to blame.
constexpr double kShared = 1.2;
constexpr std::size_t kMostTimes = 15;  ///< of a point: they leave a third of the interval that three have
constexpr double kQuick = 150;  ///< ms of processor time up to which a point is timed again; 16 min for 6,440 of them

/// For the shell.
std::string inQuotes(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

/// One that wanders between processors finds their caches cold.
void stayHere() {
    cpu_set_t here;
    CPU_ZERO(&here);
    CPU_SET(::sched_getcpu(), &here);
    ::sched_setaffinity(0, sizeof here, &here);
}

double gravityOf(const MeasureOptions& options, int repeat) {
    if (repeat == 0) return 1;
    stability::Dice dice(options.seed * 1000 + static_cast<std::uint64_t>(repeat));
    return 1 + 1e-6 * static_cast<double>(dice.between(-1, 1));
}

struct Reading {
    double value = kNone, reference = kNone, error = kNone;
    std::string quantity, unit;
};

/// Of the scene's rows the one that errs most; what is no number errs more than any.
Reading worstOf(const ChartScene& scene, const std::vector<stability::Row>& rows) {
    Reading worst;
    for (const std::string& quantity : scene.quantities) {
        const auto row = std::ranges::find(rows, scene.test + ": " + quantity, &stability::Row::name);
        if (row == rows.end()) throw std::logic_error("the suite has no row \"" + scene.test + ": " + quantity + "\"");
        const double scale = scene.scale > 0 ? scene.scale : std::abs(row->reference);
        const double error = std::abs(row->value - row->reference) / scale;
        if (!worst.quantity.empty() && error <= worst.error) continue;
        worst = {row->value, row->reference, error, quantity, row->unit};
        if (!std::isfinite(error)) break;
    }
    return worst;
}

/// Why the point has failed; empty when it has not.
std::string faultOf(const ChartScene& scene, const Trial& trial, const Reading& reading) {
    if (!trial.course().fault.empty()) return trial.course().fault;
    if (std::isfinite(trial.course().failed) && !scene.endsItself) return "fell or came apart";
    if (!std::isfinite(reading.error)) return "no number came out";
    if (reading.error >= scene.failsFrom) return "errs beyond what counts";
    return {};
}

class Measuring {
public:
    Measuring(const ChartScene& scene, const stability::Case& test, const Variant& variant, Point point,
              const MeasureOptions& options)
        : scene_(scene), test_(test), timed_(variant.timed), options_(options), point_(std::move(point)) {
        kind_ = {variant.name,
                 [&variant, setting = point_.setting](const Scene& each) { return variant.make(each, setting); }};
    }

    Point run() {
        stayHere();
        try {
            for (int i = 0; i < options_.repeats && repeat(i); ++i) ++point_.repeats;
        } catch (const stability::Unsupported& unsupported) {
            return unsupportedFor(unsupported.what());
        } catch (const stability::Missing& missing) {
            return unsupportedFor(missing.what());
        } catch (const std::exception& error) {
            point_.outcome = Outcome::failed;
            point_.reason = error.what();
        }
        // Who asks for one run wants the answer soon.
        if (options_.repeats > 1) timeFurther();
        if (times_.empty()) return point_;
        const TimeInterval interval = intervalOf(times_);
        point_.cpuMs = interval.middle;
        point_.cpuMsLow = interval.low;
        point_.cpuMsHigh = interval.high;
        return point_;
    }

private:
    Point unsupportedFor(const char* why) {
        point_.outcome = Outcome::unsupported;
        point_.reason = why;
        return point_;
    }
    Trial runOnce(double gravity) {
        Trial trial({scene_.family, scene_.test, &kind_, point_.setting.step, {}, 1, scene_.longest, gravity});
        test_.run(trial);
        spent_ += trial.cpuMs();
        return trial;
    }
    /// More times of what is quick, so that their interval is narrow. They tell nothing else of the point.
    void timeFurther() {
        while (point_.outcome == Outcome::measured && point_.alone && times_.size() < kMostTimes && spent_ < kQuick)
            keepTime(runOnce(1));
    }
    /// False once the point has failed.
    bool repeat(int number) {
        const Trial trial = runOnce(gravityOf(options_, number));
        const Reading reading = worstOf(scene_, trial.rows());
        const std::string fault = faultOf(scene_, trial, reading);
        if (number == 0) keepFirst(trial, reading);
        keepTime(trial);
        if (!fault.empty()) {
            point_.outcome = Outcome::failed;
            point_.reason = fault;
            point_.failedAt = std::min(trial.course().failed, trial.simulated());
            return false;
        }
        point_.outcome = Outcome::measured;
        point_.errorLow = std::min(point_.errorLow, reading.error);
        point_.errorHigh = std::max(point_.errorHigh, reading.error);
        return true;
    }
    /// Times of runs that had the processor for themselves drive out those of others.
    void keepTime(const Trial& trial) {
        const bool alone = timed_ && trial.course().wallMs <= kShared * trial.cpuMs();
        if (alone != point_.alone && !times_.empty()) {
            if (!alone) return;
            times_.clear();
        }
        point_.alone = alone;
        times_.push_back(trial.cpuMs() / trial.simulated());
    }
    void keepFirst(const Trial& trial, const Reading& reading) {
        point_.digest = trial.course().digest;
        point_.value = reading.value;
        point_.reference = reading.reference;
        point_.quantity = reading.quantity;
        point_.unit = reading.unit;
        point_.error = point_.errorLow = point_.errorHigh = reading.error;
        point_.simulated = trial.simulated();
        const auto steps = static_cast<double>(trial.course().steps);
        point_.contacts = trial.course().contacts / steps;
        point_.passes = trial.course().passes / steps;
    }

    const ChartScene& scene_;
    const stability::Case& test_;
    bool timed_;
    MeasureOptions options_;
    Point point_;
    stability::EngineKind kind_;
    std::vector<double> times_;
    double spent_ = 0;  ///< ms of processor time
};

}  // namespace

Point pointOf(const ChartScene& scene, const Variant& variant, const Setting& setting, const MeasureOptions& options) {
    Point point;
    point.scene = scene.name;
    point.quantity = scene.quantities.front();
    point.referenceKind = nameOf(scene.reference);
    point.engine = variant.engine;
    point.version = variant.version;
    point.variant = variant.name;
    point.setting = setting;
    const Setting& standard = variant.standard;
    point.isDefault = setting.step == standard.step && setting.substeps == standard.substeps &&
                      setting.iterations == standard.iterations;
    point.seed = options.seed;
    point.command = "ragtop_bench chart --point " + inQuotes(point.key());
    if (!variant.engineCommand.empty()) point.command += " --engine-command " + inQuotes(variant.engineCommand);
    return point;
}

Point measure(const ChartScene& scene, const stability::Case& test, const Variant& variant, Point point,
              const MeasureOptions& options) {
    return Measuring(scene, test, variant, std::move(point), options).run();
}

}  // namespace ragtop::chart
