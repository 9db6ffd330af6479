#include "limit_analysis.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine.h"

#ifdef RAGTOP_WITH_GLPK
#include <glpk.h>
#endif

namespace ragtop::stability {
namespace {

DVec3 crossed(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

DVec3 turnedAboutY(const DVec3& a, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {a.x * c + a.z * s, a.y, a.z * c - a.x * s};
}

}  // namespace

int LimitAnalysis::addBlock(double weight, const DVec3& center) {
    blocks_.push_back({center, {0, -weight, 0}, {}});
    return static_cast<int>(blocks_.size()) - 1;
}

void LimitAnalysis::addForce(int block, const DVec3& force, const DVec3& point) {
    Block& b = blocks_[static_cast<std::size_t>(block)];
    b.moment = b.moment + crossed(point - b.center, force);
    b.force = b.force + force;
}

void LimitAnalysis::addJoint(Joint joint) { joints_.push_back(std::move(joint)); }

void LimitAnalysis::addGuide(int block, const DVec3& axis) { guides_.push_back({block, axis}); }

double bisect(double good, double bad, double tolerance, const std::function<bool(double)>& holds) {
    if (!holds(good) || holds(bad)) return std::numeric_limits<double>::quiet_NaN();
    while (std::abs(good - bad) > tolerance * std::abs(good + bad) / 2) {
        const double middle = (good + bad) / 2;
        (holds(middle) ? good : bad) = middle;
    }
    return (good + bad) / 2;
}

#ifdef RAGTOP_WITH_GLPK

namespace {

/// Six equations per block, and for each point of a joint as many unknowns as the cone has edges: how much of each.
class Program {
public:
    explicit Program(std::size_t blocks) : problem_(glp_create_prob()) {
        glp_add_rows(problem_, 6 * static_cast<int>(blocks));
    }
    ~Program() { glp_delete_prob(problem_); }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    void setLoad(int block, const DVec3& force, const DVec3& moment) {
        const double loads[] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
        for (int i = 0; i < 6; ++i) glp_set_row_bnds(problem_, 6 * block + i + 1, GLP_FX, -loads[i], -loads[i]);
    }
    /// What a force of any size does to a block.
    struct Effect {
        int block;
        DVec3 force, moment;
    };
    /// A force of unknown size, zero or more, by what its unit does to two blocks.
    void addUnknown(const Effect& a, const Effect& b) {
        count_ = 0;
        // A block that touches its own copy has both in the same equations.
        if (a.block == b.block) {
            addEffect({a.block, a.force + b.force, a.moment + b.moment});
        } else {
            addEffect(a);
            addEffect(b);
        }
        addColumn(GLP_LO);
    }
    /// Forces across an axis and moments of any size.
    void addReactions(int block, const DVec3& axis) {
        const DVec3 units[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (const DVec3& unit : units) {
            addFree({block, crossed(axis, unit), {}});
            addFree({block, {}, unit});
        }
    }
    /// Of loads that differ by far the simplex method may go in circles: it is asked for so many steps, then with
    /// scaled rows, then the interior-point method.
    bool isFeasible() {
        constexpr int kSteps = 20000;  // some hundred are usual
        glp_smcp options;
        glp_init_smcp(&options);
        options.msg_lev = GLP_MSG_OFF;
        options.presolve = GLP_ON;
        options.it_lim = kSteps;
        if (glp_simplex(problem_, &options) != GLP_EITLIM) return glp_get_status(problem_) == GLP_OPT;
        glp_term_out(GLP_OFF);  // scaling has no level of messages
        glp_scale_prob(problem_, GLP_SF_AUTO);
        glp_term_out(GLP_ON);
        if (glp_simplex(problem_, &options) != GLP_EITLIM) return glp_get_status(problem_) == GLP_OPT;
        glp_iptcp interior;
        glp_init_iptcp(&interior);
        interior.msg_lev = GLP_MSG_OFF;
        return glp_interior(problem_, &interior) == 0 && glp_ipt_status(problem_) == GLP_OPT;
    }

private:
    void addFree(const Effect& effect) {
        count_ = 0;
        addEffect(effect);
        addColumn(GLP_FR);
    }
    void addColumn(int bounds) {
        const int column = glp_add_cols(problem_, 1);
        glp_set_col_bnds(problem_, column, bounds, 0, 0);
        glp_set_mat_col(problem_, column, count_, rows_, values_);
    }
    void addEffect(const Effect& effect) {
        const auto& [block, force, moment] = effect;
        if (block == kGround) return;
        const double entries[] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
        for (int i = 0; i < 6; ++i) {
            if (entries[i] == 0) continue;
            rows_[++count_] = 6 * block + i + 1;
            values_[count_] = entries[i];
        }
    }
    glp_prob* problem_;
    int count_ = 0;
    int rows_[13];
    double values_[13];
};

}  // namespace

bool LimitAnalysis::stands(double friction) const {
    Program program(blocks_.size());
    for (std::size_t i = 0; i < blocks_.size(); ++i)
        program.setLoad(static_cast<int>(i), blocks_[i].force, blocks_[i].moment);
    const auto effect = [&](int block, const DVec3& force, const DVec3& point) {
        if (block == kGround) return Program::Effect{block, {}, {}};
        return Program::Effect{block, force, crossed(point - blocks_[static_cast<std::size_t>(block)].center, force)};
    };
    for (const Joint& joint : joints_) {
        const DVec3 across = crossed(joint.normal, joint.tangent);
        for (int edge = 0; edge < edges_; ++edge) {
            const double angle = 2 * std::numbers::pi * edge / edges_;
            const DVec3 onB = joint.normal + friction * (std::cos(angle) * joint.tangent + std::sin(angle) * across);
            const DVec3 onA = turnedAboutY(-1.0 * onB, -joint.turn);
            for (const DVec3& point : joint.points)
                program.addUnknown(effect(joint.a, onA, turnedAboutY(point, -joint.turn)), effect(joint.b, onB, point));
        }
    }
    for (const Guide& guide : guides_) program.addReactions(guide.block, guide.axis);
    return program.isFeasible();
}

#else

bool LimitAnalysis::stands(double) const { throw Missing("this program was built without GLPK"); }

#endif

}  // namespace ragtop::stability
