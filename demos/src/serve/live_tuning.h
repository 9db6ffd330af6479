#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ragtop/scene_tuning.h"
#include "snapshots.h"

namespace ragtop::live {

/// The tunables of a running world and what they are set to: those of a scene, then those that a program adds.
class Tuning {
public:
    /// `scene` as it runs now, and as its files say where that differs. Fields of `extras` must outlive it.
    Tuning(Scene scene, const Scene& asInFiles, RunningScene running, std::vector<TunableRef> extras = {});

    /// With the values that they have now.
    const std::vector<TunableField>& fields() const { return fields_; }
    /// What the files say, in the order of the fields.
    const TuneState& defaults() const { return defaults_; }
    const Scene& scene() const { return scene_; }
    /// The field of that path. Throws TuneError.
    const TunableField& field(const std::string& path) const;
    /// Those that differ from what the files say.
    std::vector<TunedValue> changed() const;

    /// All or none. Throws TuneError.
    void set(std::span<const TunedValue> values);
    /// Other defaults, for as many fields.
    void setDefaults(const Scene& asInFiles);

    /// Values of all fields; shared until one changes.
    std::shared_ptr<const TuneState> state() const;
    void restore(const TuneState& state);

private:
    std::size_t find(const std::string& path) const;

    Scene scene_;
    RunningScene running_;
    std::vector<TunableRef> extras_;
    std::vector<TunableField> fields_;
    std::size_t ofScene_ = 0;  // fields before the extras
    std::map<std::string, std::size_t> index_;
    TuneState defaults_;
    mutable std::shared_ptr<const TuneState> state_;
};

}  // namespace ragtop::live
