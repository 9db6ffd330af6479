#include "masses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace ragtop {
namespace {

constexpr double kLeastDensity = 300, kMostDensity = 2000;  ///< kg/m³, of any part
constexpr double kFlesh = 1000;                             ///< kg/m³, of bodies that are no human
/// Times the share of the table that volume makes of a human's part at most, unless that is lighter than any flesh:
/// helmets, hair and wide clothes are hollow.
constexpr double kTableRoom = 2;
/// Mean logarithm of the ratio between the shares of volume and those of the table. Shapes around people, clothes and
/// all, are off by less than a factor of two on the average; at a factor of four nothing is left of the table.
constexpr double kLikeHumans = 0.6931, kUnlikeHumans = 1.3863;

/// The role that has the share of one that a rig does not have.
constexpr std::array<std::pair<BodyRole, BodyRole>, 8> kCarriers{{
    {BodyRole::hand, BodyRole::forearm},
    {BodyRole::forearm, BodyRole::upperArm},
    {BodyRole::foot, BodyRole::shank},
    {BodyRole::shank, BodyRole::thigh},
    {BodyRole::neck, BodyRole::head},
    {BodyRole::head, BodyRole::chest},
    {BodyRole::abdomen, BodyRole::pelvis},
    {BodyRole::chest, BodyRole::pelvis},
}};

int findPart(std::span<const MassPart> parts, BodyRole role, BodySide side) {
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i].role == role && parts[i].side == side) return static_cast<int>(i);
    return -1;
}

/// Shares of the table, where each part has also those of parts that would hang on it.
std::vector<double> tableShares(std::span<const MassPart> parts, double femaleShare) {
    std::vector<double> shares;
    for (const MassPart& part : parts) shares.push_back(massShare(part.role, femaleShare));
    for (const BodySide side : {BodySide::middle, BodySide::left, BodySide::right})
        for (const auto& [role, carrier] : kCarriers) {
            const bool middle = carrier == BodyRole::chest || carrier == BodyRole::pelvis;
            if (middle != (side == BodySide::middle) || findPart(parts, role, side) >= 0) continue;
            for (BodyRole at = carrier;;) {
                if (const int found = findPart(parts, at, side); found >= 0) {
                    shares[static_cast<std::size_t>(found)] += massShare(role, femaleShare);
                    break;
                }
                const auto next = std::find_if(kCarriers.begin(), kCarriers.end(),
                                               [&](const auto& entry) { return entry.first == at; });
                if (next == kCarriers.end()) break;
                at = next->second;
            }
        }
    return shares;
}

double sumOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

/// What a part may weigh, kg.
struct Room {
    double least = 0, most = 0;
};

/// Shares in proportion to which the mass is given out, and room for each.
struct Wanted {
    std::vector<double> shares;
    std::vector<Room> rooms;
    double departure = 1;
};

Wanted wantedByVolume(std::span<const MassPart> parts, double volume) {
    Wanted wanted;
    for (const MassPart& part : parts) {
        wanted.shares.push_back(part.volume / volume);
        wanted.rooms.push_back({kLeastDensity * part.volume, kMostDensity * part.volume});
    }
    return wanted;
}

/// Tails, wings and the like are by volume; the table shares out the rest.
Wanted wantedOfHuman(std::span<const MassPart> parts, double volume, double femaleShare, double mass) {
    Wanted wanted = wantedByVolume(parts, volume);
    std::vector<double>& shares = wanted.shares;
    std::vector<double> table = tableShares(parts, femaleShare);
    const double tableSum = sumOf(table);
    double human = 0;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (table[i] > 0) human += shares[i];
    double off = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!(table[i] > 0)) continue;
        table[i] *= human / tableSum;
        off += table[i] / human * std::abs(std::log(shares[i] / table[i]));
    }
    const double t = std::clamp((off - kLikeHumans) / (kUnlikeHumans - kLikeHumans), 0.0, 1.0);
    wanted.departure = t * t * (3 - 2 * t);
    // A mass that leaves all of it lighter than flesh keeps to the table before it keeps to densities.
    const bool hollow = mass < kLeastDensity * volume;
    double least = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Room& room = wanted.rooms[i];
        if (table[i] > 0) {
            shares[i] += (1 - wanted.departure) * (table[i] - shares[i]);
            room.most = std::clamp(table[i] * mass * kTableRoom, hollow ? 0.0 : room.least, room.most);
            room.least = std::min(room.least, room.most);
        }
        least += room.least;
    }
    if (least > mass)
        for (Room& room : wanted.rooms) room.least *= mass / least;
    return wanted;
}

/// Masses in proportion to shares but for those that meet a bound; halving finds the factor that gives the sum.
std::vector<double> bounded(const Wanted& wanted, double mass) {
    const auto masses = [&](double factor) {
        std::vector<double> result;
        for (std::size_t i = 0; i < wanted.shares.size(); ++i)
            result.push_back(std::clamp(factor * wanted.shares[i], wanted.rooms[i].least, wanted.rooms[i].most));
        return result;
    };
    double low = 0, high = mass;
    while (sumOf(masses(high)) < mass) high *= 2;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (sumOf(masses(middle)) < mass ? low : high) = middle;
    }
    return masses(high);
}

std::string noteOfDeparture(double departure) {
    constexpr double kTold = 0.01;  // masses within that of the table are the table's
    if (departure < kTold) return {};
    char text[160];
    std::snprintf(text, sizeof text,
                  "its parts have not the proportions of a human: masses go by volume, not by the table, for %.0f %%",
                  100 * departure);
    return text;
}

/// Where a human is given less than clothes of flesh would weigh.
std::string noteOfHollow(std::span<const MassPart> parts, const std::vector<double>& mass) {
    constexpr double kRounding = 1e-6;
    int count = 0;
    double least = kLeastDensity;
    BodyRole role{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const double density = mass[i] / parts[i].volume;
        if (density >= (1 - kRounding) * kLeastDensity) continue;
        ++count;
        if (density < least) least = density, role = parts[i].role;
    }
    if (count == 0) return {};
    char text[200];
    std::snprintf(text, sizeof text,
                  "%d part%s lighter than %g kg/m3, the lightest (%.*s) has %.3g: %.4g kg are little for its volume",
                  count, count == 1 ? " is" : "s are", kLeastDensity, static_cast<int>(nameOf(role).size()),
                  nameOf(role).data(), least, sumOf(mass));
    return text;
}

/// Where the densities of flesh in each part are another mass than the height says.
std::string noteOfMass(double mass, double byHeight) {
    constexpr double kTold = 0.01;
    if (std::abs(mass - byHeight) < kTold * byHeight) return {};
    const bool more = mass > byHeight;
    char text[200];
    std::snprintf(text, sizeof text,
                  "it weighs %.4g kg, not the %.4g kg of its height, by which parts were %s than %g kg/m3", mass,
                  byHeight, more ? "lighter" : "heavier", more ? kLeastDensity : kMostDensity);
    return text;
}

}  // namespace

Masses shareMass(std::span<const MassPart> parts, const MassWish& wish) {
    double volume = 0;
    for (const MassPart& part : parts) volume += part.volume;
    const double likely = wish.human ? wish.bodyMassIndex * wish.height * wish.height : kFlesh * volume;
    double mass = wish.bodyMass ? *wish.bodyMass : std::max(likely, kLeastDensity * volume);
    const Wanted wanted =
        wish.human ? wantedOfHuman(parts, volume, wish.femaleShare, mass) : wantedByVolume(parts, volume);
    Masses result;
    result.departure = wanted.departure;
    std::vector<std::string> notes;
    if (wish.human) notes.push_back(noteOfDeparture(wanted.departure));
    double least = 0, most = 0;
    for (const Room& part : wanted.rooms) least += part.least, most += part.most;
    if (!wish.bodyMass) {
        // Large clothes leave no part lighter than flesh where the body weighs more.
        mass = std::clamp(likely, least, most);
        result.mass = bounded(wanted, mass);
        notes.push_back(noteOfMass(mass, likely));
    } else if ((wish.human || mass >= least) && mass < most) {
        result.mass = bounded(wanted, mass);
        if (wish.human) notes.push_back(noteOfHollow(parts, result.mass));
    } else {
        for (const MassPart& part : parts) result.mass.push_back(mass * part.volume / volume);
        char text[160];
        std::snprintf(text, sizeof text,
                      "%.4g kg are %.3g kg/m3 in its %.3g m3, where %g to %g is flesh: shared by volume", mass,
                      mass / volume, volume, kLeastDensity, kMostDensity);
        notes = {text};
    }
    for (const std::string& note : notes)
        if (!note.empty()) result.note += (result.note.empty() ? "" : "; ") + note;
    return result;
}

}  // namespace ragtop
