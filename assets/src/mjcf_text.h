#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "xml_text.h"

namespace ragtop {

/// Attributes of elements by the names of these.
using MjcfDefaults = std::map<std::string, std::map<std::string, std::string>>;

/// Elements and attributes by name, that were looked for.
using MjcfAsked = std::set<std::pair<std::string, std::string>>;

/// An element of a description with the attributes that its default class gives it.
class MjcfElement {
public:
    MjcfElement(const TiXmlElement& xml, std::string file, const MjcfDefaults* defaults, MjcfAsked& asked)
        : xml_(&xml), file_(std::move(file)), defaults_(defaults), asked_(&asked) {}

    const TiXmlElement& xml() const { return *xml_; }
    const std::string& tag() const { return xml_->ValueStr(); }
    /// Null where neither the element nor its class has it.
    const std::string* find(const char* attribute) const;
    std::string text(const char* attribute, const std::string& otherwise = {}) const;
    /// "geom 'left_foot'"
    std::string name() const;

    // Throw AssetError with file, line and value where it is something else.
    double number(const char* attribute, double otherwise) const;
    /// At least `least` numbers, at most as many as there is room for; how many. None: 0.
    int numbers(const char* attribute, std::span<double> values, int least) const;
    /// Empty: "auto" or not there.
    std::optional<bool> truth(const char* attribute) const;
    [[noreturn]] void fail(const std::string& message) const;
    [[noreturn]] void failAt(const char* attribute, const std::string& allowed) const;

private:
    const TiXmlElement* xml_;
    std::string file_;
    const MjcfDefaults* defaults_;
    MjcfAsked* asked_;
};

/// A description of MuJoCo [MuJoCo 2.2, XML reference] with what it includes; notes which of its elements are made use
/// of.
class MjcfText {
public:
    /// `root` and what is below it lives as long as `path`'s text.
    MjcfText(const std::filesystem::path& path, const TiXmlElement& root);

    const TiXmlElement& root() const { return root_; }
    /// Children of an element, those of included files in their place.
    const std::vector<const TiXmlElement*>& children(const TiXmlElement& element);
    /// With the defaults of `childClass` unless it names another class; it counts as made use of.
    MjcfElement use(const TiXmlElement& element, const std::string& childClass = {});
    std::string fileOf(const TiXmlElement& element) const;

    /// Every element but the root: its own name, that of what it is in, and whether both were made use of.
    struct Use {
        std::string tag, parent;
        bool used = false, parentUsed = false;
    };
    std::vector<Use> uses();
    /// Attributes of elements that were made use of, which nobody has looked for: how often each is there, by element
    /// and name.
    std::map<std::pair<std::string, std::string>, int> attributesLeftOut();

private:
    void readDefaults(const TiXmlElement& element, const std::string& parent);
    const TiXmlElement& included(const TiXmlElement& include);
    [[noreturn]] void fail(const TiXmlElement& at, const std::string& message) const;

    std::filesystem::path path_;
    const TiXmlElement& root_;
    std::map<std::string, MjcfDefaults> classes_;
    std::map<std::filesystem::path, std::unique_ptr<XmlText>> included_;
    std::map<const TiXmlElement*, std::vector<const TiXmlElement*>> children_;
    std::set<const TiXmlElement*> used_;
    MjcfAsked asked_;
};

}  // namespace ragtop
