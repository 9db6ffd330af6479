#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine.h"
#include "ragtop/recording.h"
#include "ragtop/world.h"

namespace ragtop::stability {

enum class Verdict { holds, fails, skipped };

/// One measured quantity and its verdict.
struct Row {
    std::string family, name, engine;
    double value = 0;
    double reference = 0;  ///< what it should be
    double bound = 0;      ///< how far it may be off
    std::string unit;
    Verdict verdict = Verdict::fails;
    double ms = 0;     ///< processor time per simulated second, without setting up and measuring
    std::string note;  ///< what went wrong in the run, whatever the value, or why it was skipped
};

class Trial;

/// A scene on its way through one engine.
class Run {
public:
    ~Run();
    Run(Run&&) noexcept;

    void step();
    /// Steps for so many seconds, or as long as the trial allows; ends early, and returns false, when `goOn` returns
    /// false after a step.
    bool advance(double seconds, const std::function<bool()>& goOn = {});
    double time() const;
    double dt() const;

    BodyMotion motion(int body) const { return engine_->motion(body); }
    DVec3 position(int body) const { return motion(body).pose.position; }
    double height(int body) const { return position(body).y; }
    DVec3 centerOfMass(int body) const;
    Engine& engine() { return *engine_; }
    void remove(int body);
    const Scene& scene() const { return scene_; }

    /// Largest distance between two points that a joint should hold together, m; rods and ropes do not count.
    double jointGap() const;
    /// Kinetic and potential energy of the dynamic bodies, J; potential is zero at the origin.
    double energy() const;
    /// About the centre of mass, world axes, kg m²/s.
    DVec3 angularMomentum(int body) const;
    /// How far a body is from where it began, m.
    double moved(int body) const;

private:
    friend class Trial;
    Run(Trial& trial, Scene scene, const std::string& label);
    /// Whether a body is nowhere, or the engine has something to complain of.
    void inspect();
    void fail();
    struct Film;

    Trial* trial_;
    Scene scene_;
    std::vector<MassProperties> masses_;
    std::unique_ptr<Engine> engine_;
    std::unique_ptr<Film> film_;
    int steps_ = 0;
    bool lost_ = false;  ///< a body is nowhere: nothing is left to be simulated
};

/// One case in one engine: starts runs and files rows.
class Trial {
public:
    struct Setting {
        std::string family, name;
        const EngineKind* engine = nullptr;
        double dt = 1.0 / 60;
        std::optional<std::filesystem::path> records;  ///< folder for recordings of the runs
        int starts = 8;                                ///< runs of a case that depends on where its bodies begin
        double longest = std::numeric_limits<double>::infinity();  ///< s, that a run is continued for at once
        double gravity = 1;                                        ///< factor, to tell how a case depends on its bits
    };
    explicit Trial(Setting setting) : setting_(std::move(setting)) {}

    double dt() const { return setting_.dt; }
    /// For cases that are about the step.
    void setStep(double dt) { setting_.dt = dt; }
    const EngineKind& engine() const { return *setting_.engine; }

    /// `label` tells runs of one case apart.
    Run start(Scene scene, const std::string& label = "");

    // Bounds are for 60 steps a second; longer steps may be off by proportionally more, as a first-order method is.
    // Nothing passes once a body of a run was nowhere or an engine had something to complain of.
    /// Passes when |value − reference| ≤ bound.
    void expectNear(const std::string& what, double value, double reference, double bound, const std::string& unit);
    /// Passes when |value| ≤ bound; the reference is zero.
    void expectAtMost(const std::string& what, double value, double bound, const std::string& unit);
    /// Passes when value ≥ reference; the bound is zero.
    void expectAtLeast(const std::string& what, double value, double reference, const std::string& unit);

    /// Instead of one of these, where what it asks for cannot be told.
    void skip(const std::string& what, const std::string& why);

    const std::vector<Row>& rows() const { return rows_; }
    /// How many times a case runs that depends on where exactly its bodies begin, each time from other places.
    int starts() const { return setting_.starts; }

    /// What the runs had in common.
    struct Course {
        std::uint64_t digest = 0;                                 ///< of their scenes
        double failed = std::numeric_limits<double>::infinity();  ///< s into the run that failed first, if any did
        double contacts = 0, passes = 0;                          ///< sums over all steps, of what the engine told
        long steps = 0;
        double wallMs = 0;  ///< of stepping, by the clock; more than the processor's where it was shared
        std::string fault;  ///< why a run failed, where that is more than what was measured of it
    };
    const Course& course() const { return course_; }
    /// Milliseconds of processor time that the runs took so far, and the seconds that they simulated.
    double cpuMs() const { return cpuMs_; }
    double simulated() const { return simulated_; }

private:
    friend class Run;
    double allowance() const;
    void file(const std::string& what, double value, double reference, double bound, const std::string& unit,
              bool pass);

    Setting setting_;
    std::vector<Row> rows_;
    Course course_;
    double cpuMs_ = 0;
    double simulated_ = 0;
};

}  // namespace ragtop::stability
