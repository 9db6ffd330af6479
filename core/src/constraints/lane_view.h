#pragma once

#include <cstdint>
#include <cstring>

#include "constraints/contact_layout.h"
#include "ragtop/math.h"

namespace ragtop {

/// The fields of one contact in its bundle.
class LaneView {
public:
    LaneView(float* lane, int lanes) : lane_(lane), stride_(static_cast<std::size_t>(lanes)) {}
    float& at(int field) { return lane_[static_cast<std::size_t>(field) * stride_]; }
    float& at(int point, int field) { return at(contact::kPoints + point * contact::kPointFields + field); }
    void set(int field, const Vec3& v) { at(field) = v.x, at(field + 1) = v.y, at(field + 2) = v.z; }
    Vec3 vector(int field) { return {at(field), at(field + 1), at(field + 2)}; }
    void setBits(int field, std::uint32_t bits) { std::memcpy(&at(field), &bits, sizeof bits); }

private:
    float* lane_;
    std::size_t stride_;
};

/// The same to read only.
class LaneReader {
public:
    LaneReader(const float* lane, int lanes) : lane_(lane), stride_(static_cast<std::size_t>(lanes)) {}
    float at(int field) const { return lane_[static_cast<std::size_t>(field) * stride_]; }
    float at(int point, int field) const { return at(contact::kPoints + point * contact::kPointFields + field); }
    Vec3 vector(int field) const { return {at(field), at(field + 1), at(field + 2)}; }

private:
    const float* lane_;
    std::size_t stride_;
};

}  // namespace ragtop
