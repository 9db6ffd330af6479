#include "stage.h"

#include "ragtop/asset_error.h"

namespace ragtop::live {

const std::vector<Blob>& Stage::blobs() const {
    static const std::vector<Blob> none;
    return none;
}

std::unique_ptr<Stage> Stage::opened(const std::string& scene) {
    throw AssetError("scene is \"" + scene + "\", must not be given: this world is a program's own and the only one");
}

std::string Stage::saveTuning(const std::string&) {
    throw AssetError("this world is a program's own and has no file that a tuning could extend");
}

std::vector<TunedValue> Stage::savedTuning(const std::string& name) {
    throw AssetError("there is no tuning \"" + name + "\": this world is a program's own");
}

}  // namespace ragtop::live
