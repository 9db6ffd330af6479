#include "mjcf_text.h"

#include <algorithm>
#include <utility>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

constexpr std::size_t kMostIncludes = 64;

/// Actuators of all kinds share one set of defaults.
std::string defaultsKey(const std::string& tag) {
    return tag == "motor" || tag == "position" || tag == "velocity" ? "general" : tag;
}

}  // namespace

const std::string* MjcfElement::find(const char* attribute) const {
    asked_->emplace(defaultsKey(tag()), attribute);
    if (const std::string* own = xml_->Attribute(std::string(attribute))) return own;
    if (!defaults_) return nullptr;
    const auto element = defaults_->find(defaultsKey(tag()));
    if (element == defaults_->end()) return nullptr;
    const auto found = element->second.find(attribute);
    return found == element->second.end() ? nullptr : &found->second;
}

std::string MjcfElement::text(const char* attribute, const std::string& otherwise) const {
    const std::string* found = find(attribute);
    return found ? *found : otherwise;
}

std::string MjcfElement::name() const {
    const std::string* own = xml_->Attribute(std::string("name"));
    return own ? tag() + " '" + *own + "'" : tag();
}

void MjcfElement::fail(const std::string& message) const {
    throw AssetError(file_, std::to_string(xml_->Row()), name() + ": " + message);
}

void MjcfElement::failAt(const char* attribute, const std::string& allowed) const {
    fail(std::string(attribute) + " is '" + text(attribute) + "', must be " + allowed);
}

int MjcfElement::numbers(const char* attribute, std::span<double> values, int least) const {
    const std::string* found = find(attribute);
    if (!found) return 0;
    const int count = readNumbers(*found, values);
    const std::string most = std::to_string(values.size());
    if (count < least)
        failAt(attribute, most == std::to_string(least) ? most + (least == 1 ? " number" : " numbers")
                                                        : std::to_string(least) + " to " + most + " numbers");
    return count;
}

double MjcfElement::number(const char* attribute, double otherwise) const {
    double value = otherwise;
    numbers(attribute, {&value, 1}, 1);
    return value;
}

std::optional<bool> MjcfElement::truth(const char* attribute) const {
    const std::string value = text(attribute, "auto");
    if (value == "auto") return {};
    if (value != "true" && value != "false") failAt(attribute, "true or false");
    return value == "true";
}

MjcfText::MjcfText(const std::filesystem::path& path, const TiXmlElement& root) : path_(path), root_(root) {
    classes_[""] = {};
    for (const TiXmlElement* element : children(root))
        if (element->ValueStr() == "default") readDefaults(*element, "");
}

void MjcfText::fail(const TiXmlElement& at, const std::string& message) const {
    throw AssetError(fileOf(at), std::to_string(at.Row()), message);
}

std::string MjcfText::fileOf(const TiXmlElement& element) const {
    for (const auto& [path, text] : included_)
        if (&text->document == element.GetDocument()) return path.string();
    return path_.string();
}

/// A class begins with what the one it is in has so far.
void MjcfText::readDefaults(const TiXmlElement& element, const std::string& parent) {
    struct Waiting {
        const TiXmlElement* element;
        std::string parent;
        bool top;
    };
    std::vector<Waiting> waiting{{&element, parent, true}};
    while (!waiting.empty()) {
        const Waiting at = waiting.back();
        waiting.pop_back();
        used_.insert(at.element);
        const std::string* named = at.element->Attribute(std::string("class"));
        if (!at.top && !named) fail(*at.element, "default has no class, must have one within another default");
        const std::string name = at.top ? "" : *named;
        if (!at.top && classes_.contains(name)) fail(*at.element, "default class '" + name + "' is there twice");
        MjcfDefaults defaults = classes_.at(at.parent);
        for (const TiXmlElement* child : children(*at.element)) {
            if (child->ValueStr() == "default") continue;
            used_.insert(child);
            auto& attributes = defaults[defaultsKey(child->ValueStr())];
            for (const TiXmlAttribute* a = child->FirstAttribute(); a; a = a->Next())
                attributes[a->NameTStr()] = a->ValueStr();
        }
        classes_[name] = defaults;
        if (at.top && named) classes_[*named] = defaults;
        const auto& inner = children(*at.element);
        for (auto child = inner.rbegin(); child != inner.rend(); ++child)
            if ((*child)->ValueStr() == "default") waiting.push_back({*child, name, false});
    }
}

const TiXmlElement& MjcfText::included(const TiXmlElement& include) {
    const std::string* file = include.Attribute(std::string("file"));
    if (!file) fail(include, "include has no file");
    const std::filesystem::path folder = path_.parent_path();
    const std::filesystem::path place = (folder / *file).lexically_normal();
    const std::filesystem::path inside = place.lexically_relative(folder.lexically_normal());
    if (std::filesystem::path(*file).is_absolute() || inside.empty() || *inside.begin() == "..")
        fail(include, "include file is '" + *file + "', must be a file in the folder of the description");
    if (included_.size() >= kMostIncludes || included_.contains(place))
        fail(include, "include file is '" + *file + "', must be one of at most " + std::to_string(kMostIncludes) +
                          " files that are included once");
    auto text = std::make_unique<XmlText>();
    readXml(place, *text);
    const TiXmlElement* root = text->document.RootElement();
    if (!root) throw AssetError(place.string(), "", "has no element");
    included_[place] = std::move(text);
    return *root;
}

const std::vector<const TiXmlElement*>& MjcfText::children(const TiXmlElement& element) {
    const auto known = children_.find(&element);
    if (known != children_.end()) return known->second;
    std::vector<const TiXmlElement*> found;
    // Includes of included files come where these were, the first of them first.
    std::vector<const TiXmlElement*> waiting;
    const auto add = [&](const TiXmlElement& parent) {
        std::vector<const TiXmlElement*> own;
        for (const TiXmlElement* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) own.push_back(e);
        waiting.insert(waiting.end(), own.rbegin(), own.rend());
    };
    add(element);
    while (!waiting.empty()) {
        const TiXmlElement* next = waiting.back();
        waiting.pop_back();
        if (next->ValueStr() != "include") {
            found.push_back(next);
            continue;
        }
        used_.insert(next);
        found.push_back(next);
        add(included(*next));
    }
    return children_[&element] = std::move(found);
}

MjcfElement MjcfText::use(const TiXmlElement& element, const std::string& childClass) {
    used_.insert(&element);
    const std::string* own = element.Attribute(std::string("class"));
    const std::string name = own ? *own : childClass;
    const auto found = classes_.find(name);
    if (found == classes_.end())
        fail(element, "class '" + name + "' does not exist, must be one of the default classes");
    return {element, fileOf(element), &found->second, asked_};
}

std::vector<MjcfText::Use> MjcfText::uses() {
    std::vector<Use> all;
    struct Waiting {
        const TiXmlElement* element;
        bool used;
    };
    std::vector<Waiting> waiting{{&root_, true}};
    while (!waiting.empty()) {
        const Waiting at = waiting.back();
        waiting.pop_back();
        for (const TiXmlElement* child : children(*at.element)) {
            const bool used = at.used && used_.contains(child);
            all.push_back({child->ValueStr(), at.element->ValueStr(), used, at.used});
            if (child->ValueStr() != "include") waiting.push_back({child, used});
        }
    }
    return all;
}

std::map<std::pair<std::string, std::string>, int> MjcfText::attributesLeftOut() {
    const std::set<std::string> known{"name", "class", "childclass", "model", "file"};
    std::map<std::pair<std::string, std::string>, int> left;
    for (const TiXmlElement* element : used_)
        for (const TiXmlAttribute* a = element->FirstAttribute(); a; a = a->Next())
            if (!known.contains(a->NameTStr()) && !asked_.contains({defaultsKey(element->ValueStr()), a->NameTStr()}))
                ++left[{element->ValueStr(), a->NameTStr()}];
    return left;
}

}  // namespace ragtop
