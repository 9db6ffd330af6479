#pragma once

#include <tinyxml.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace ragtop {

/// XML that is sound, and flat enough for parsers that call themselves for each level.
struct XmlText {
    std::string source;
    TiXmlDocument document;
};

/// Throws AssetError with the place: absent, longer than 32 MiB, nested beyond 64 levels, no XML.
void readXml(const std::filesystem::path& path, XmlText& into);

/// The element after `element` in the order of the text, of those in `top`; null at the end.
const TiXmlElement* nextElement(const TiXmlElement* element, const TiXmlElement& top, bool intoIt = true);

/// Numbers separated by blanks, finite and in single precision's range: how many; −1 where there is something else, or
/// more than there is room for.
int readNumbers(std::string_view text, std::span<double> values);

}  // namespace ragtop
