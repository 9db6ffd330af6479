#include "masses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "human.h"
#include "ragtop/ragdoll.h"

namespace ragtop {
namespace {

constexpr double kHumanVolume = 0.075;  ///< m³

/// Parts of a human, each with the volume of its share of the table times `scale` of its role.
template <class Scale>
std::vector<MassPart> humanParts(Scale scale) {
    std::vector<MassPart> parts;
    const auto add = [&](BodyRole role, BodySide side) {
        parts.push_back({role, side, massShare(role, 0) * kHumanVolume * scale(role)});
    };
    for (const BodyRole role : {BodyRole::pelvis, BodyRole::abdomen, BodyRole::chest, BodyRole::head})
        add(role, BodySide::middle);
    for (const BodySide side : {BodySide::left, BodySide::right})
        for (const BodyRole role :
             {BodyRole::upperArm, BodyRole::forearm, BodyRole::hand, BodyRole::thigh, BodyRole::shank, BodyRole::foot})
            add(role, side);
    return parts;
}

double total(const Masses& masses) {
    double sum = 0;
    for (const double mass : masses.mass) sum += mass;
    return sum;
}

constexpr MassWish kPerson{true, 0, 24.49, 1.75, 75};

TEST(Masses, OfHumanProportionsAreThoseOfTheTable) {
    // Shapes around people are too large here and too small there, by a third on the average.
    for (const double off : {0.0, 0.3}) {
        int sign = 1;
        const auto parts = humanParts([&](BodyRole) { return 1 + (sign = -sign) * off; });
        const Masses masses = shareMass(parts, kPerson);
        EXPECT_EQ(masses.departure, 0);
        for (std::size_t i = 0; i < parts.size(); ++i)
            EXPECT_NEAR(masses.mass[i], 75 * massShare(parts[i].role, 0) / 0.9999, 1e-2 * masses.mass[i]);
    }
}

TEST(Masses, GoFromTheTableToVolumeAsTheHeadGrows) {
    double before = 0, departure = 0;
    for (const double size : {1.0, 3.0, 6.0, 12.0, 24.0, 48.0}) {
        const auto parts = humanParts([&](BodyRole role) { return role == BodyRole::head ? size : 1.0; });
        const Masses masses = shareMass(parts, {true, 0, 24.49, 1.75, 100});
        EXPECT_GE(masses.departure, departure);
        EXPECT_GE(masses.mass[3], before - 1e-9);
        departure = masses.departure;
        before = masses.mass[3];
        EXPECT_NEAR(total(masses), 100, 1e-9);
    }
    EXPECT_EQ(departure, 1);
    EXPECT_EQ(shareMass(humanParts([](BodyRole) { return 1.0; }), kPerson).note, "");
}

TEST(Masses, OfHumansKeepEveryDensityBetween300And2000WhateverTheyWear) {
    const double byHeight = 24.49 * 1.75 * 1.75;
    for (const double all : {0.2, 0.7, 1.0, 4.0, 20.0})
        for (const double one : {0.05, 1.0, 48.0}) {
            const auto parts = humanParts([&](BodyRole role) { return all * (role == BodyRole::head ? one : 1.0); });
            const Masses masses = shareMass(parts, {true, 0, 24.49, 1.75, {}});
            for (std::size_t i = 0; i < parts.size(); ++i) {
                EXPECT_GE(masses.mass[i] / parts[i].volume, 300 * (1 - 1e-9)) << all << " " << one;
                EXPECT_LE(masses.mass[i] / parts[i].volume, 2000 * (1 + 1e-9)) << all << " " << one;
            }
            // Of another mass than its height says only where that is more or less than the bounds allow, which is
            // told.
            const bool told = masses.note.find("of its height") != std::string::npos;
            EXPECT_EQ(told, std::abs(total(masses) - byHeight) > 0.01 * byHeight) << masses.note;
            EXPECT_TRUE(all != 1.0 || one != 1.0 || !told);
        }
    const auto helmet = humanParts([](BodyRole role) { return role == BodyRole::head ? 48.0 : 1.0; });
    EXPECT_NE(shareMass(helmet, {true, 0, 24.49, 1.75, {}}).note.find("kg of its height, by which parts were lighter"),
              std::string::npos);
}

TEST(Masses, OfHumansThatAreGivenTooLittleKeepToTwiceTheTableAndSaySo) {
    for (const double hand : {0.2, 1.0, 20.0}) {
        const auto parts = humanParts([&](BodyRole role) { return 20 * (role == BodyRole::hand ? hand : 1.0); });
        const Masses masses = shareMass(parts, kPerson);
        EXPECT_NEAR(total(masses), 75, 1e-9 * 75);
        for (std::size_t i = 0; i < parts.size(); ++i)
            EXPECT_LE(masses.mass[i], 2.001 * 75 * massShare(parts[i].role, 0) / 0.9999);
        EXPECT_NE(masses.note.find("lighter than 300 kg/m3, the lightest ("), std::string::npos) << masses.note;
        EXPECT_NE(masses.note.find("75 kg are little for its volume"), std::string::npos) << masses.note;
    }
}

TEST(Masses, OfOthersKeepEveryDensityBetween300And2000WhereTheSumAllows) {
    for (const double hand : {0.05, 1.0, 20.0})
        for (const double mass : {40.0, 75.0, 120.0}) {
            const auto parts = humanParts([&](BodyRole role) { return role == BodyRole::hand ? hand : 1.0; });
            const Masses masses = shareMass(parts, {false, 0, 24.49, 1.75, mass});
            EXPECT_NEAR(total(masses), mass, 1e-9 * mass);
            for (std::size_t i = 0; i < parts.size(); ++i) {
                EXPECT_GE(masses.mass[i] / parts[i].volume, 300 * (1 - 1e-9));
                EXPECT_LE(masses.mass[i] / parts[i].volume, 2000 * (1 + 1e-9));
            }
        }
}

TEST(Masses, AreByVolumeAndSaySoWhereNoDensityIsLikely) {
    const auto parts = humanParts([](BodyRole) { return 1.0; });
    const Masses light = shareMass(parts, {false, 0, 24.49, 1.75, 7.5});
    EXPECT_NEAR(total(light), 7.5, 1e-9);
    EXPECT_NE(light.note.find("7.5 kg are 100 kg/m3"), std::string::npos) << light.note;
    EXPECT_NEAR(light.mass[0] / parts[0].volume, 100, 0.1);
    const Masses heavy = shareMass(parts, {true, 0, 24.49, 1.75, 300});
    EXPECT_NE(heavy.note.find("300 kg are 4e+03 kg/m3"), std::string::npos) << heavy.note;
    EXPECT_NEAR(heavy.mass[0] / parts[0].volume, 4000, 4);
}

TEST(Masses, OfHandsThatAreMissingGoToTheForearm) {
    auto parts = humanParts([](BodyRole) { return 1.0; });
    std::erase_if(parts,
                  [](const MassPart& part) { return part.role == BodyRole::hand && part.side == BodySide::left; });
    const Masses masses = shareMass(parts, kPerson);
    double left = 0, right = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].role != BodyRole::forearm && parts[i].role != BodyRole::hand) continue;
        (parts[i].side == BodySide::left ? left : right) += masses.mass[i];
    }
    EXPECT_NEAR(left, right, 1e-6);
}

TEST(Masses, OfAHumanGoWithTheSquareOfTheHeightAndOfOthersWithTheVolume) {
    const auto parts = humanParts([](BodyRole) { return 1.0; });
    double volume = 0;
    for (const MassPart& part : parts) volume += part.volume;
    EXPECT_NEAR(total(shareMass(parts, {true, 0, 20, 1.75, {}})), 20 * 1.75 * 1.75, 1e-6);
    EXPECT_NEAR(total(shareMass(parts, {false, 0, 20, 1.75, {}})), 1000 * volume, 1e-6);
}

TEST(MakeRagdoll, WeighsATailByItsVolume) {
    HumanRig rig;
    int bone = rig.hips;
    for (int i = 0; i < 5; ++i)
        bone = rig.add(bone, {0, 0.9f - 0.05f * static_cast<float>(i), -0.1f - 0.1f * static_cast<float>(i)});
    rig.add(bone, {0, 0.65f, -0.6f});
    const RagdollDef def = makeRagdoll(rig.skeleton, {.bodyMass = 80});
    double sum = 0, tail = 0, thigh = 0, shank = 0;
    for (const RagdollPart& part : def.parts) {
        sum += static_cast<double>(part.mass);
        if (part.role == BodyRole::tail) tail += static_cast<double>(part.mass);
        if (part.role == BodyRole::thigh) thigh = static_cast<double>(part.mass);
        if (part.role == BodyRole::shank) shank = static_cast<double>(part.mass);
    }
    EXPECT_NEAR(sum, 80, 1e-5 * 80);
    EXPECT_GT(tail, 0);
    // The others keep the ratios of the table.
    EXPECT_NEAR(thigh / shank, massShare(BodyRole::thigh, 0) / massShare(BodyRole::shank, 0), 1e-3);
}

}  // namespace
}  // namespace ragtop
