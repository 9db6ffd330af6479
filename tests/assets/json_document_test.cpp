#include "json_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

using testing::HasSubstr;

std::string complaintOf(const std::string& text) {
    try {
        JsonDocument::parse(text, "f.json");
    } catch (const AssetError& error) {
        return error.what();
    }
    return "";
}

TEST(JsonDocument, KnowsWhereEachValueBegins) {
    const auto document = JsonDocument::parse(
        "// a comment, { not \"JSON\"\n{\n  \"a\": [1, /* two */ 2],\n"
        "  \"b/c\": {\"d\": \"x\\\"}\"}\n}\n",
        "f.json");
    EXPECT_EQ(document.place("").line, 2);
    EXPECT_EQ(document.place("/a").column, 8);
    EXPECT_EQ(document.place("/a/1").line, 3);
    EXPECT_EQ(document.place("/a/1").column, 22);
    EXPECT_EQ(document.place("/b~1c/d").line, 4);
    EXPECT_EQ(document.place("/b~1c/d").column, 16);
}

TEST(JsonDocument, PlacesWhatIsMissingAtWhatShouldHaveIt) {
    const auto document = JsonDocument::parse("{\n  \"a\": {}\n}", "f.json");
    EXPECT_EQ(document.place("/a/b/c").line, 2);
}

TEST(JsonDocument, RefusesEqualKeysInOneObjectOnly) {
    EXPECT_EQ(complaintOf("{\"a\": {\"a\": 1}, \"b\": {\"a\": 2}}"), "");
    EXPECT_THAT(complaintOf("{\"a\": 1,\n \"a\": 2}"), HasSubstr("f.json:2:2: /a occurs twice"));
    EXPECT_THAT(complaintOf("{\"a\": 1, \"\\u0061\": 2}"), HasSubstr("/a occurs twice"));
}

TEST(JsonDocument, TakesNestingUpToItsLimit) {
    const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_EQ(complaintOf(nested(64)), "");
    EXPECT_THAT(complaintOf(nested(66)), HasSubstr("64 levels"));
    EXPECT_THAT(complaintOf(nested(100000)), HasSubstr("64 levels"));
}

TEST(JsonDocument, RefusesEveryPrefixOfAText) {
    const std::string text = "{\"a\": [1.5e3, true, null], /* c */ \"b\": \"\\u00e9\"}";
    for (std::size_t length = 0; length < text.size(); ++length) {
        EXPECT_NE(complaintOf(text.substr(0, length)), "") << length;
    }
    EXPECT_EQ(complaintOf(text), "");
}

TEST(JsonDocument, LayersMembersAndReplacesLists) {
    auto over = JsonDocument::parse("{\"a\": {\"x\": 1}, \"list\": [9]}", "over.json");
    over.layOver(JsonDocument::parse("{\"a\": {\"x\": 0, \"y\": 2}, \"list\": [1, 2, 3], \"c\": 4}", "base.json"));
    EXPECT_EQ(over.root()["a"]["x"], 1);
    EXPECT_EQ(over.root()["a"]["y"], 2);
    EXPECT_EQ(over.root()["list"].size(), 1u);
    EXPECT_EQ(over.place("/a/x").file, "over.json");
    EXPECT_EQ(over.place("/a/y").file, "base.json");
}

TEST(JsonDocument, SetsValuesByPath) {
    auto document = JsonDocument::parse("{\"list\": [{\"x\": 1}]}", "f.json");
    document.set("list.0.x", 5, "here");
    document.set("new.thing", true, "here");
    EXPECT_EQ(document.root()["list"][0]["x"], 5);
    EXPECT_EQ(document.root()["new"]["thing"], true);
    EXPECT_THROW(document.set("list.7.x", 5, "here"), AssetError);
    EXPECT_THROW(document.set("list.0.x.y", 5, "here"), AssetError);
}

TEST(JsonDocument, ObjectsOverListsChangeElementsByName) {
    JsonDocument base =
        JsonDocument::parse("{\"parts\": [{\"name\": \"head\", \"mass\": 4}, {\"name\": \"hip\"}]}", "base");
    JsonDocument over = JsonDocument::parse("{\n\"parts\": {\n \"hip\": {\"mass\": 9}}}", "over");
    over.layOver(base);
    EXPECT_EQ(over.root().dump(), "{\"parts\":[{\"name\":\"head\",\"mass\":4},{\"name\":\"hip\",\"mass\":9}]}");
    EXPECT_EQ(over.place("/parts/1/mass").file, "over");
    EXPECT_EQ(over.place("/parts/1/mass").line, 3);
    EXPECT_EQ(over.place("/parts/0/mass").file, "base");
    JsonDocument strange = JsonDocument::parse("{\n\"parts\": {\"knee\": {}}}", "over");
    try {
        strange.layOver(base);
        FAIL();
    } catch (const AssetError& error) {
        EXPECT_STREQ(error.what(), "over:2:19: /parts/knee is no element of the list, must be one of head, hip");
    }
}

}  // namespace
}  // namespace ragtop
