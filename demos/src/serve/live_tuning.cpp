#include "live_tuning.h"

#include <algorithm>
#include <utility>

namespace ragtop::live {

Tuning::Tuning(Scene scene, const Scene& asInFiles, RunningScene running, std::vector<TunableRef> extras)
    : scene_(std::move(scene)), running_(std::move(running)), extras_(std::move(extras)), fields_(tunablesOf(scene_)) {
    ofScene_ = fields_.size();
    for (const TunableRef& ref : extras_) fields_.push_back(ref.field);
    for (std::size_t i = 0; i < fields_.size(); ++i) index_.emplace(fields_[i].path, i);
    setDefaults(asInFiles);
}

void Tuning::setDefaults(const Scene& asInFiles) {
    defaults_.clear();
    for (const TunableField& field : tunablesOf(asInFiles)) defaults_.push_back(field.value);
    for (const TunableRef& ref : extras_) defaults_.push_back(ref.field.value);
}

std::size_t Tuning::find(const std::string& path) const {
    const auto found = index_.find(path);
    if (found != index_.end()) return found->second;
    throw TuneError(
        path, "path is \"" + path + "\", must be that of one of the " + std::to_string(fields_.size()) + " tunables");
}

const TunableField& Tuning::field(const std::string& path) const { return fields_[find(path)]; }

std::vector<TunedValue> Tuning::changed() const {
    std::vector<TunedValue> values;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        if (fields_[i].value != defaults_[i]) values.emplace_back(fields_[i].path, fields_[i].value);
    }
    return values;
}

void Tuning::set(std::span<const TunedValue> values) {
    std::vector<TunedValue> ofScene;
    std::vector<std::pair<std::size_t, TuneValue>> ofProgram;
    for (const TunedValue& one : values) {
        const std::size_t i = find(one.first);
        if (i < ofScene_) {
            ofScene.push_back(one);
            continue;
        }
        if (const std::string why = whyInvalid(fields_[i], one.second); !why.empty()) throw TuneError(one.first, why);
        ofProgram.emplace_back(i, one.second);
    }
    if (!ofScene.empty()) {
        apply(scene_, tune(scene_, ofScene), running_);
        std::vector<TunableField> now = tunablesOf(scene_);
        std::move(now.begin(), now.end(), fields_.begin());
    }
    for (const auto& [i, value] : ofProgram) {
        extras_[i - ofScene_].set(value);
        fields_[i].value = value;
    }
    state_.reset();
}

std::shared_ptr<const TuneState> Tuning::state() const {
    if (!state_) {
        TuneState values;
        for (const TunableField& field : fields_) values.push_back(field.value);
        state_ = std::make_shared<const TuneState>(std::move(values));
    }
    return state_;
}

void Tuning::restore(const TuneState& state) {
    std::vector<TunedValue> different;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        if (fields_[i].value != state[i]) different.emplace_back(fields_[i].path, state[i]);
    }
    if (!different.empty()) set(different);
}

}  // namespace ragtop::live
