#include "suite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "families.h"
#include "red_rows.h"

namespace ragtop::stability {
namespace {

/// CI in the environment for as long as it lives, and what was there before again.
class Ci {
public:
    explicit Ci(const char* value) {
        if (const char* old = std::getenv("CI")) before_ = old;
        setenv("CI", value, 1);
    }
    Ci(const Ci&) = delete;
    Ci& operator=(const Ci&) = delete;
    ~Ci() {
        if (before_)
            setenv("CI", before_->c_str(), 1);
        else
            unsetenv("CI");
    }

private:
    std::optional<std::string> before_;
};

std::vector<Row> rowsOf(const EngineKind& kind, const std::string& filter) {
    SuiteOptions options;
    options.engines = {&kind};
    options.filter = std::regex(filter);
    std::vector<Row> rows;
    runSuite(options, [&](const std::vector<Row>& more) { rows.insert(rows.end(), more.begin(), more.end()); });
    return rows;
}

TEST(Suite, SaysWhatItWasBuiltWithoutAndFailsInCi) {
    const EngineKind absent{"bullet", nullptr};
    for (const bool inCi : {false, true}) {
        const Ci ci(inCi ? "true" : "false");
        const std::vector<Row> rows = rowsOf(absent, "^stopping/");
        ASSERT_EQ(rows.size(), 1u);
        EXPECT_EQ(rows[0].engine, "bullet");
        EXPECT_EQ(rows[0].verdict, inCi ? Verdict::fails : Verdict::skipped);
        EXPECT_EQ(rows[0].note, "this program was built without it");
    }
}

TEST(Suite, SaysWhatAnEngineCannotRepresent) {
    const EngineKind unable{"unable", [](const Scene&) -> std::unique_ptr<Engine> { throw Unsupported("boxes"); }};
    const Ci ci("true");
    const std::vector<Row> rows = rowsOf(unable, "^stopping/");
    ASSERT_FALSE(rows.empty());
    for (const Row& row : rows) {
        EXPECT_EQ(row.verdict, Verdict::skipped) << row.name;
        EXPECT_EQ(row.note, "boxes") << row.name;
    }
}

TEST(Suite, MissesRowsThatAreGone) {
    const Ci ci("false");
    for (const Selection selection : {Selection::brief, Selection::normal}) {
        Row row;
        row.engine = "ragtop";
        row.verdict = Verdict::holds;
        std::vector<Row> rows(static_cast<std::size_t>(expectedRows(selection)), row);
        EXPECT_EQ(whyTooFew(rows, selection), "");
        rows.back().engine = "bullet";
        const std::string why =
            std::to_string(rows.size() - 1) + " rows of Ragtop's, " + std::to_string(rows.size()) + " are expected";
        EXPECT_EQ(whyTooFew(rows, selection), why);
        // A case that is skipped has one row in the place of some, which is in order where not all is installed.
        rows[0].verdict = Verdict::skipped;
        EXPECT_EQ(whyTooFew(rows, selection), "");
        const Ci inCi("true");
        EXPECT_EQ(whyTooFew(rows, selection), why);
    }
}

TEST(Suite, RunsAtTheRatesThatAreAskedFor) {
    SuiteOptions options;
    options.engines = {&engineKinds()[0]};
    options.filter = std::regex("^stack/n=10( @|$)");
    const std::vector<std::string> usual = selectedCases(options);
    ASSERT_FALSE(usual.empty());
    options.rates = {60, 480};
    std::vector<std::string> expected;
    for (const std::string& name : usual) expected.insert(expected.end(), {name, name + " @ 1/480 s"});
    EXPECT_EQ(selectedCases(options), expected);
}

TEST(Suite, NarrowsToTheCasesThatHaveRedRows) {
    SuiteOptions options;
    options.engines = {&engineKinds()[0]};
    options.redOnly = true;
    const std::vector<std::string> cases = selectedCases(options);
    for (const std::string& name : cases) EXPECT_TRUE(hasRedRow(name)) << name;
    for (const RedRow& red : kRedRows)
        EXPECT_TRUE(std::ranges::any_of(cases, [&](const std::string& name) { return red.name.starts_with(name); }))
            << red.name;
}

TEST(Suite, RunsSomethingOfEveryFamilyInEveryBuild) {
    SuiteOptions options;
    options.engines = {&engineKinds()[0]};
    options.selection = Selection::brief;
    const std::vector<std::string> cases = selectedCases(options);
    for (const Family& family : allFamilies())
        EXPECT_TRUE(std::ranges::any_of(cases, [&](const std::string& name) {
            return name.starts_with(family.name + "/");
        })) << family.name;
}

}  // namespace
}  // namespace ragtop::stability
