// Reflectance lobes in every basis: [Gautron2004] "A Novel Hemispherical Basis for Accurate and Efficient
// Rendering", Eq. 15 and Figs. 4 and 5, and the dot products with an environment of Sec. 6.1.
#include "tools/measure/basis_brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/basis_conversion.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"

namespace prt::tools {
namespace {

using std::numbers::pi;

/// Nodes over the hemisphere, Gauss–Legendre in t = √z on both sides of a cut and trapezoid in azimuth: as
/// domainQuadrature, for functions that jump at z = cut.
std::vector<DomainNode> cutQuadrature(double cut, int degree) {
    if (cut <= 0) return domainQuadrature(BasisDomain::UpperHemisphere, degree);
    const std::vector<LineNode> line = gaussLegendre(degree + 1);
    const int columns = degree + 1;
    std::vector<DomainNode> nodes;
    for (const auto& [low, high] : {std::pair(0.0, std::sqrt(cut)), std::pair(std::sqrt(cut), 1.0)})
        for (const LineNode& row : line) {
            const double t = low + (high - low) * (row.z + 1) / 2, z = t * t;
            const double sine = std::sqrt((1 - z) * (1 + z));
            const double weight = row.weight * (high - low) * t * 2 * pi / columns;
            for (int j = 0; j < columns; ++j) {
                const double phi = 2 * pi * (j + 0.5) / columns;
                nodes.push_back({Vec3d(sine * std::cos(phi), sine * std::sin(phi), z), weight});
            }
        }
    return nodes;
}

/// Functions of one basis at all nodes, function after function.
class SampledBasis {
  public:
    SampledBasis(const Basis& basis, std::span<const DomainNode> nodes)
        : nodes_(nodes.size()), values_(size_t(basis.count()) * nodes.size()) {
        parallelFor(nodes.size(), 1024, [&](size_t begin, size_t end) {
            std::vector<double> at(size_t(basis.count()));
            for (size_t k = begin; k < end; ++k) {
                basis.eval(nodes[k].direction, at);
                for (size_t i = 0; i < at.size(); ++i) values_[i * nodes_ + k] = at[i];
            }
        });
    }
    std::span<double> function(size_t i) { return {values_.data() + i * nodes_, nodes_}; }
    std::span<const double> function(size_t i) const { return {values_.data() + i * nodes_, nodes_}; }
    size_t count() const { return values_.size() / nodes_; }

  private:
    size_t nodes_;
    std::vector<double> values_;
};

double dot(std::span<const double> weights, std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (size_t k = 0; k < weights.size(); ++k) sum += weights[k] * a[k] * b[k];
    return sum;
}

/// a += factor · b
void addScaled(std::span<double> a, double factor, std::span<const double> b) {
    for (size_t k = 0; k < a.size(); ++k) a[k] += factor * b[k];
}

/// m of shIndex(l, m) = l(l + 1) + m.
int azimuthalOrder(size_t index) {
    const int band = int(std::sqrt(double(index)));
    return int(index) - band * (band + 1);
}

/// Gram–Schmidt over spherical harmonics in their order, twice each: orthonormal functions of the same spans,
/// so that projection on the first n² of them is the least-squares fit of order n. Functions of different m
/// are orthogonal on these nodes as they are.
void orthonormalise(SampledBasis& basis, std::span<const double> weights) {
    for (size_t i = 0; i < basis.count(); ++i) {
        throwIfInterrupted();
        for (int pass = 0; pass < 2; ++pass)
            for (size_t j = 0; j < i; ++j) {
                if (azimuthalOrder(j) != azimuthalOrder(i)) continue;
                addScaled(basis.function(i), -dot(weights, basis.function(i), basis.function(j)),
                          basis.function(j));
            }
        const double scale = 1 / std::sqrt(dot(weights, basis.function(i), basis.function(i)));
        for (double& value : basis.function(i)) value *= scale;
    }
}

/// One family whose functions of order n are the first of those of any larger order.
struct LobeFamily {
    std::string basis;
    int maxOrder;
};

class LobeProjection {
  public:
    LobeProjection(std::span<const Lobe> lobes, int maxOrder, int degree)
        : nodes_(cutQuadrature(lobes.front().lowestZ, degree)), lobes_(lobes) {
        for (const Lobe& lobe : lobes) PRT_CHECK_EQ(lobe.lowestZ, lobes.front().lowestZ);
        for (const DomainNode& node : nodes_) weights_.push_back(node.weightSr);
        for (const Lobe& lobe : lobes)
            for (const DomainNode& node : nodes_) values_.push_back(lobe.function(node.direction));
        int triangular = 1;
        while ((triangular + 1) * (triangular + 2) / 2 <= maxOrder * maxOrder) ++triangular;
        families_ = {{"hsh", maxOrder},       {"sh", maxOrder},        {"esh", triangular},
                     {"zernike", triangular}, {"makhotkin", maxOrder}, {"lsosh", maxOrder}};
    }

    std::vector<LobeAccuracy> run() const {
        std::vector<LobeAccuracy> rows;
        for (const LobeFamily& family : families_) measure(family, rows);
        return rows;
    }

  private:
    void measure(const LobeFamily& family, std::vector<LobeAccuracy>& rows) const {
        const auto basis = makeBasis(family.basis, family.maxOrder);
        SampledBasis sampled(*basis, nodes_);
        const bool leastSquares = family.basis == "lsosh";
        if (leastSquares) orthonormalise(sampled, weights_);
        std::vector<double> projecting = weights_;
        bool unitWeight = true;
        for (size_t k = 0; k < projecting.size(); ++k) {
            projecting[k] *= basis->weight(nodes_[k].direction);
            unitWeight = unitWeight && projecting[k] == weights_[k];
        }
        std::vector<std::vector<LobeAccuracy>> found(lobes_.size());
        parallelFor(lobes_.size(), 1, [&](size_t begin, size_t end) {
            for (size_t lobe = begin; lobe < end; ++lobe)
                found[lobe] = ofLobe(lobe, family, sampled, projecting, unitWeight && !leastSquares);
        });
        for (const auto& of : found) rows.insert(rows.end(), of.begin(), of.end());
    }

    /// @param byCoefficients  Eq. 15 by the sum of squares
    std::vector<LobeAccuracy> ofLobe(size_t lobe, const LobeFamily& family, const SampledBasis& sampled,
                                     std::span<const double> projecting, bool byCoefficients) const {
        const std::span<const double> f(values_.data() + lobe * nodes_.size(), nodes_.size());
        const double energy = dot(weights_, f, f);
        std::vector<double> rest(f.begin(), f.end());
        std::vector<LobeAccuracy> rows;
        double captured = 0;
        size_t used = 0;
        for (int order = 1; order <= family.maxOrder; ++order) {
            const bool triangular = family.basis == "esh" || family.basis == "zernike";
            const int count = triangular ? order * (order + 1) / 2 : order * order;
            for (; used < size_t(count); ++used) {
                const double c = dot(projecting, f, sampled.function(used));
                captured += c * c;
                addScaled(rest, -c, sampled.function(used));
            }
            const double hemisphere = 1 - dot(weights_, rest, rest) / energy;
            rows.push_back({lobe, family.basis, order, count, family.basis == "esh" ? order * order : count,
                            byCoefficients ? captured / energy : hemisphere, hemisphere});
        }
        return rows;
    }

    std::vector<DomainNode> nodes_;
    std::span<const Lobe> lobes_;
    std::vector<double> weights_;  ///< [nodes]
    std::vector<double> values_;   ///< [lobes×nodes]
    std::vector<LobeFamily> families_;
};

/// Coefficients to be dotted with those of an environment.
struct LobeCoefficients {
    std::vector<double> sh, esh, lsosh, hsh;
};

LobeCoefficients projectLobe(const Lobe& lobe, int order) {
    constexpr int kDegree = 127;
    LobeCoefficients result;
    const auto hsh = makeBasis("hsh", order), lsosh = makeBasis("lsosh", order),
               esh = makeBasis("esh", order);
    result.hsh = hsh->project(lobe.function, kDegree);
    result.lsosh = lsosh->project(lobe.function, kDegree);
    result.esh = eshToShCoefficients(order, esh->project(lobe.function, kDegree));
    // f vanishes below the horizon: its spherical harmonics are integrals over the hemisphere
    result.sh.assign(size_t(shCount(order)), 0.0);
    std::vector<double> values(result.sh.size());
    for (const DomainNode& node : domainQuadrature(BasisDomain::UpperHemisphere, kDegree)) {
        evalSh(order, node.direction, values);
        const double f = node.weightSr * lobe.function(node.direction);
        for (size_t i = 0; i < values.size(); ++i) result.sh[i] += f * values[i];
    }
    return result;
}

double plainDot(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

/// What leaves for one lobe, environment, orientation and colour.
struct Outgoing {
    double truth = 0;
    std::array<double, 4> estimates{};  ///< as kEstimates
};
constexpr const char* kEstimates[] = {"sh", "hsh", "esh", "lsosh"};

/// All colours of one environment in one orientation, for all lobes.
/// @param toHsh  C
void addOutgoing(std::span<const Lobe> lobes, std::span<const LobeCoefficients> coefficients,
                 const EnvironmentLights& lights, const Mat3d& turn, int order, std::span<const double> toHsh,
                 std::vector<Outgoing>& out) {
    const size_t count = size_t(shCount(order));
    const std::vector<Vec3d> directions = turnedDirections(lights, turn);
    std::array<std::vector<double>, 3> light, lightHsh;
    light.fill(std::vector<double>(count, 0.0));
    std::vector<Outgoing> found(lobes.size() * 3);
    std::vector<double> values(count);
    for (size_t k = 0; k < directions.size(); ++k) {
        evalSh(order, directions[k], values);
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < count; ++i) light[c][i] += lights.fluxes[c][k] * values[i];
        if (directions[k].z() < 0) continue;
        for (size_t l = 0; l < lobes.size(); ++l) {
            const double f = lobes[l].function(directions[k]);
            for (size_t c = 0; c < 3; ++c) found[3 * l + c].truth += f * lights.fluxes[c][k];
        }
    }
    for (size_t c = 0; c < 3; ++c) {
        for (size_t i = 0; i < count; ++i)
            lightHsh[c].push_back(plainDot(toHsh.subspan(i * count, count), light[c]));
        for (size_t l = 0; l < lobes.size(); ++l)
            found[3 * l + c].estimates = {
                plainDot(coefficients[l].sh, light[c]), plainDot(coefficients[l].hsh, lightHsh[c]),
                plainDot(coefficients[l].esh, light[c]), plainDot(coefficients[l].lsosh, light[c])};
    }
    out.insert(out.end(), found.begin(), found.end());
}

}  // namespace

std::vector<LobeAccuracy> lobeAccuracies(std::span<const Lobe> lobes, int maxOrder, int degree) {
    PRT_CHECK(!lobes.empty());
    PRT_CHECK_LE(1, maxOrder);
    PRT_CHECK_LE(maxOrder, 16);
    return LobeProjection(lobes, maxOrder, degree).run();
}

std::vector<LightError> lightErrors(std::span<const Lobe> lobes,
                                    std::span<const EnvironmentLights> environments, int order,
                                    int orientations, uint64_t seed) {
    PRT_CHECK_LE(1, order);
    PRT_CHECK_LE(order, 12);
    PRT_CHECK_LE(1, orientations);
    std::vector<LobeCoefficients> coefficients(lobes.size());
    parallelFor(lobes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t l = begin; l < end; ++l) coefficients[l] = projectLobe(lobes[l], order);
    });
    const std::vector<double> toHsh = shToHshMatrix(order, order);
    std::vector<std::vector<Outgoing>> found(environments.size() * size_t(orientations));
    parallelFor(found.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            SignalRandom random(seed * 0x9e3779b97f4a7c15u + i);
            addOutgoing(lobes, coefficients, environments[i / size_t(orientations)], random.rotation(), order,
                        toHsh, found[i]);
        }
    });
    std::vector<LightError> errors;
    for (size_t e = 0; e < std::size(kEstimates); ++e) {
        double wrong = 0, all = 0;
        std::vector<double> relative;
        for (const auto& of : found)
            for (const Outgoing& outgoing : of) {
                const double error = outgoing.estimates[e] - outgoing.truth;
                wrong += error * error;
                all += outgoing.truth * outgoing.truth;
                if (outgoing.truth > 0) relative.push_back(std::abs(error) / outgoing.truth);
            }
        std::sort(relative.begin(), relative.end());
        errors.push_back({kEstimates[e], order, all > 0 ? std::sqrt(wrong / all) : 0,
                          relative.empty() ? 0 : relative[relative.size() / 2],
                          relative.empty() ? 0 : relative.back()});
    }
    return errors;
}

}  // namespace prt::tools
