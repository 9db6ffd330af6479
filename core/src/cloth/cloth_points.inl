// Points of cloth side by side in lanes: four floats of each as columns.

#pragma once

#include "cloth/cloth_kernels.h"
#include "solve/lane_rows.h"

namespace ragtop::cloth {
namespace {

/// How far rows are from the first, in bytes: anywhere, and evenly.
struct BytesAt {
    const std::uint32_t* bytes;
    RAGTOP_INLINE std::ptrdiff_t operator[](int i) const { return bytes[i]; }
};
struct BytesEvery {
    std::ptrdiff_t first, across;
    RAGTOP_INLINE std::ptrdiff_t operator[](int i) const { return first + i * across; }
};
template <class Row, class Bytes>
struct RowsAt {
    Row* first;
    Bytes bytes;
    RAGTOP_INLINE float* operator[](int i) const {
        return reinterpret_cast<float*>(reinterpret_cast<char*>(first) + bytes[i]);
    }
};
template <class Row, class Bytes>
RAGTOP_INLINE RowsAt<Row, Bytes> rowsAt(Row* first, Bytes bytes) {
    return {first, bytes};
}
template <class Row>
RAGTOP_INLINE RowsAt<Row, BytesAt> rowsAt(Row* first, const std::uint32_t* bytes) {
    return {first, {bytes}};
}

/// The rows of a bundle by position, of which rungs have two.
template <int N, bool kEven>
struct BundleRows {
    const std::uint32_t* rows;
    EvenRows even;

    RAGTOP_INLINE auto at(int position) const {
        if constexpr (kEven) {
            return BytesEvery{even.first + static_cast<std::ptrdiff_t>(position) * even.along, even.across};
        } else {
            return BytesAt{rows + position * N};
        }
    }
    RAGTOP_INLINE auto at(int rung, int end) const {
        if constexpr (kEven) {
            return BytesEvery{even.first + static_cast<std::ptrdiff_t>(rung) * even.along + end * even.beside, even.across};
        } else {
            return BytesAt{rows + (2 * rung + end) * N};
        }
    }
};

/// Rows one after the other.
template <int N, class Row>
struct RowsInOrder {
    using Float = std::conditional_t<std::is_const_v<Row>, const float, float>;
    Row* rows;
    RAGTOP_INLINE Float* operator[](int i) const { return reinterpret_cast<Float*>(rows + i); }
};
template <int N, class Row>
RAGTOP_INLINE RowsInOrder<N, Row> inOrder(Row* rows) {
    return {rows};
}
/// Half of them.
template <class Rows>
struct HalfOfRows {
    const Rows& rows;
    int first;
    RAGTOP_INLINE auto* operator[](int i) const { return rows[first + i]; }
};

/// out[i][lane] = rows[lane][i] of four floats.
template <int N, class Rows>
RAGTOP_INLINE void gather4(const Rows& rows, Lanes<N> out[4]) {
    if constexpr (N * sizeof(float) > kNativeBytes) {
        for (int k = 0; k < 2; ++k) {
            Lanes<N / 2> half[4];
            gather4<N / 2>(HalfOfRows<Rows>{rows, N / 2 * k}, half);
            for (int i = 0; i < 4; ++i) setPiece(out[i].v, k, half[i].v);
        }
    } else if constexpr (N == 4) {
        Float4 r[4];
        for (int i = 0; i < 4; ++i) r[i] = *reinterpret_cast<const Float4*>(rows[i]);
        transpose4(r[0], r[1], r[2], r[3]);
        for (int i = 0; i < 4; ++i) out[i].v = r[i];
    } else if constexpr (N == 8) {
        Float8 r[4];
        for (int i = 0; i < 4; ++i) r[i] = joinHalves(rows[i], rows[i + 4]);
        transposeFours(r[0], r[1], r[2], r[3]);
        for (int i = 0; i < 4; ++i) out[i].v = r[i];
    } else {
#if defined(__AVX512F__)
        Float16 r[4];
        for (int i = 0; i < 4; ++i) r[i] = joinQuarters(rows[i], rows[i + 4], rows[i + 8], rows[i + 12]);
        transposeFours(r[0], r[1], r[2], r[3]);
        for (int i = 0; i < 4; ++i) out[i].v = r[i];
#endif
    }
}

/// Back to them; where two lanes have the same row the later lane stays.
template <int N, class Rows>
RAGTOP_INLINE void scatter4(const Rows& rows, const Lanes<N> in[4]) {
    if constexpr (N * sizeof(float) > kNativeBytes) {
        for (int k = 0; k < 2; ++k) {
            Lanes<N / 2> half[4];
            for (int i = 0; i < 4; ++i) half[i].v = pieceOf<typename Lanes<N / 2>::V>(in[i].v, k);
            scatter4<N / 2>(HalfOfRows<Rows>{rows, N / 2 * k}, half);
        }
    } else if constexpr (N == 4) {
        Float4 r[4];
        for (int i = 0; i < 4; ++i) r[i] = in[i].v;
        transpose4(r[0], r[1], r[2], r[3]);
        for (int i = 0; i < 4; ++i) *reinterpret_cast<Float4*>(rows[i]) = r[i];
    } else if constexpr (N == 8) {
        Float8 r[4];
        for (int i = 0; i < 4; ++i) r[i] = in[i].v;
        transposeFours(r[0], r[1], r[2], r[3]);
        for (int k = 0; k < 2; ++k)
            for (int i = 0; i < 4; ++i) *reinterpret_cast<Float4*>(rows[4 * k + i]) = pieceOf<Float4>(r[i], k);
    } else {
#if defined(__AVX512F__)
        Float16 r[4];
        for (int i = 0; i < 4; ++i) r[i] = in[i].v;
        transposeFours(r[0], r[1], r[2], r[3]);
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 4; ++i) *reinterpret_cast<Float4*>(rows[4 * k + i]) = pieceOf<Float4>(r[i], k);
#endif
    }
}

template <int N>
RAGTOP_INLINE WideVec3<N> wide(const Vec3& a) {
    return {Lanes<N>(a.x), Lanes<N>(a.y), Lanes<N>(a.z)};
}
template <int N>
RAGTOP_INLINE WideVec3<N> vectorOf(const Lanes<N> (&row)[4]) {
    return {row[0], row[1], row[2]};
}

template <int N, bool kTied>
struct WideTie {
    Lanes<N> tie[4];
};
template <int N>
struct WideTie<N, false> {};

/// A point, and what it is tied by where any of a bundle is. Both kinds make the same bits of a point that is not: no
/// place is −0, so that ±0 may be added to it.
template <int N, bool kTied>
struct WidePoint : WideTie<N, kTied> {
    Lanes<N> row[4];  ///< place and inverse mass

    WidePoint() = default;
    // As those of lanes, lest they be copied in pieces.
    RAGTOP_INLINE WidePoint(const WidePoint& other) { *this = other; }
    RAGTOP_INLINE WidePoint& operator=(const WidePoint& other) {
        for (int i = 0; i < 4; ++i) row[i] = other.row[i];
        if constexpr (kTied)
            for (int i = 0; i < 4; ++i) this->tie[i] = other.tie[i];
        return *this;
    }

    RAGTOP_INLINE WideVec3<N> place() const { return {row[0], row[1], row[2]}; }
    RAGTOP_INLINE Lanes<N> inverseMass() const { return row[3]; }
    /// s · d.
    RAGTOP_INLINE Lanes<N> alongTie(const WideVec3<N>& d) const {
        return dot(WideVec3<N>{this->tie[0], this->tie[1], this->tie[2]}, d);
    }

    /// x ← x + W f.
    RAGTOP_INLINE void push(const WideVec3<N>& f) {
        row[0] = row[0] + row[3] * f.x;
        row[1] = row[1] + row[3] * f.y;
        row[2] = row[2] + row[3] * f.z;
        if constexpr (kTied) {
            const Lanes<N> pull = alongTie(f);
            for (int i = 0; i < 3; ++i) row[i] = row[i] - pull * this->tie[i];
            this->tie[3] = this->tie[3] + pull;
        }
    }
    template <class Bytes>
    RAGTOP_INLINE void read(const ClothArrays& a, Bytes rows) {
        gather4<N>(rowsAt(a.points, rows), row);
        if constexpr (kTied) gather4<N>(rowsAt(a.ties, rows), this->tie);
    }
    template <class Bytes>
    RAGTOP_INLINE void write(const ClothArrays& a, Bytes rows) const {
        scatter4<N>(rowsAt(a.points, rows), row);
        if constexpr (kTied) scatter4<N>(rowsAt(a.ties, rows), this->tie);
    }
};

/// Adds to what a position of a bundle was given.
template <int N>
RAGTOP_INLINE void addReaction(float* to, const WideVec3<N>& f) {
    (Lanes<N>::load(to) + f.x).store(to);
    (Lanes<N>::load(to + N) + f.y).store(to + N);
    (Lanes<N>::load(to + 2 * N) + f.z).store(to + 2 * N);
}

/// Lanes of the floats of rows as they lie.
template <int N, class Row>
RAGTOP_INLINE Lanes<N> loadFlat(const Row* rows) {
    return Lanes<N>::load(reinterpret_cast<const float*>(rows));
}
template <int N, class Row>
RAGTOP_INLINE void storeFlat(Lanes<N> value, Row* rows) {
    value.store(reinterpret_cast<float*>(rows));
}

}  // namespace
}  // namespace ragtop::cloth
