// What all bases share: lookup by name, quadrature over their domains, projection. Integrals over the
// hemisphere are taken in t = √z, in which hemispherical harmonics [Gautron2004, Eq. 8] are polynomials but
// for factors √(1 + z) that are smooth.
#include "precompute/math/basis.h"

#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/basis_kernel.h"
#include "precompute/math/sh_legendre.h"

namespace prt {

using std::numbers::pi;

const std::vector<BasisFamily>& basisFamilies() {
    static const std::vector<BasisFamily> families = {
        {"sh", "SH", 1, kMaxShOrder},
        {"esh", "ESH", 1, kMaxShOrder},
        {"lsosh", "LSOSH", 1, kMaxShOrder},
        {"hsh", "HSH (Gautron)", 1, kMaxShOrder},
        {"makhotkin", "Makhotkin", 1, kMaxShOrder},
        {"zernike", "Zernike (Koenderink)", 1, kMaxShOrder},
        {"h", "H-basis", 2, 3},
        {"hl2", "Half-Life 2", 2, 2},
    };
    return families;
}

std::unique_ptr<Basis> makeBasis(const std::string& name, int order) {
    for (const auto& [shortName, implied] : {std::pair("h4", 2), std::pair("h6", 3)})
        if (name == shortName) {
            if (order != 0 && order != implied)
                throw InputError("basis " + name, "order " + std::to_string(order),
                                 "this name implies order " + std::to_string(implied));
            return makeBasis("h", implied);
        }
    std::string known;
    for (const BasisFamily& family : basisFamilies()) {
        known += (known.empty() ? "" : ", ") + family.name;
        if (family.name != name) continue;
        if (order < family.minOrder || order > family.maxOrder)
            throw InputError("basis " + name, "order " + std::to_string(order),
                             "give one from " + std::to_string(family.minOrder) + " to " +
                                 std::to_string(family.maxOrder));
        if (name == "sh" || name == "esh" || name == "lsosh") return detail::makeSphericalFamily(name, order);
        if (name == "hsh" || name == "makhotkin") return detail::makeHemisphericalFamily(name, order);
        if (name == "zernike") return detail::makeZernikeBasis(order);
        return detail::makeIrradianceFamily(name, order);
    }
    throw InputError("basis " + name, "no such basis", "choose one of " + known + ", h4, h6");
}

Basis::Basis(std::string name, int order, int count, BasisDomain domain, bool orthonormal)
    : name_(std::move(name)), order_(order), count_(count), domain_(domain), orthonormal_(orthonormal) {}

double Basis::domainSr() const { return domain_ == BasisDomain::Sphere ? 4 * pi : 2 * pi; }

double Basis::weight(const Vec3d&) const { return 1; }

void Basis::projectorInto(const Vec3d& direction, std::span<double> out) const { evalInto(direction, out); }

void Basis::finishProjection(std::span<double>) const {}

void Basis::checkDirection(const Vec3d& direction) const {
    constexpr double kBelowRim = 1e-6;  // what rotations in float leave of 0
    if (domain_ == BasisDomain::UpperHemisphere) PRT_CHECK_LE(-kBelowRim, direction.z());
}

void Basis::eval(const Vec3d& direction, std::span<double> out) const {
    PRT_CHECK_EQ(out.size(), size_t(count_));
    checkDirection(direction);
    evalInto(direction, out);
}

void Basis::evalGradient(const Vec3d& direction, std::span<Vec3d> out) const {
    PRT_CHECK_EQ(out.size(), size_t(count_));
    checkDirection(direction);
    gradientInto(direction, out);
}

std::vector<double> Basis::project(const DirectionFunction& function, int degree) const {
    const size_t count = size_t(count_);
    std::vector<double> values(count), result(count, 0.0);
    for (const DomainNode& node : domainQuadrature(domain_, degree)) {
        projectorInto(node.direction, values);
        const double value = node.weightSr * weight(node.direction) * function(node.direction);
        for (size_t i = 0; i < values.size(); ++i) result[i] += value * values[i];
    }
    finishProjection(result);
    return result;
}

std::vector<double> Basis::projectSamples(std::span<const Vec3d> directions,
                                          std::span<const double> values) const {
    PRT_CHECK_EQ(directions.size(), values.size());
    if (directions.empty())
        throw InputError("projection to basis " + name_, "no directions to project from",
                         "give at least one sample");
    const size_t count = size_t(count_);
    std::vector<double> functions(count), result(count, 0.0);
    const double scale = domainSr() / double(directions.size());
    for (size_t k = 0; k < directions.size(); ++k) {
        checkDirection(directions[k]);
        projectorInto(directions[k], functions);
        const double value = scale * weight(directions[k]) * values[k];
        for (size_t i = 0; i < functions.size(); ++i) result[i] += value * functions[i];
    }
    finishProjection(result);
    return result;
}

double Basis::evalExpansion(std::span<const double> coefficients, const Vec3d& direction) const {
    PRT_CHECK_EQ(coefficients.size(), size_t(count_));
    double values[shCount(kMaxShOrder)];
    eval(direction, std::span(values).first(size_t(count_)));
    double sum = 0;
    for (size_t i = 0; i < coefficients.size(); ++i) sum += coefficients[i] * values[i];
    return sum;
}

std::vector<DomainNode> domainQuadrature(BasisDomain domain, int degree) {
    PRT_CHECK_LE(0, degree);
    std::vector<DomainNode> nodes;
    if (domain == BasisDomain::Sphere) {
        const std::vector<SphereNode> sphere = sphereQuadrature(degree);
        nodes.reserve(sphere.size());
        for (const SphereNode& node : sphere) nodes.push_back({node.direction, node.weightSr});
        return nodes;
    }
    // x²+ y² = 1 − t⁴ and dz = 2t dt: a polynomial of the degree is one of 2·degree + 1 in t.
    const std::vector<LineNode> rows = gaussLegendre(degree + 1);
    const int columns = degree + 1;
    nodes.reserve(rows.size() * size_t(columns));
    for (const LineNode& row : rows) {
        const double t = (row.z + 1) / 2, z = t * t;
        const double sinTheta = std::sqrt((1 - z) * (1 + z));
        for (int j = 0; j < columns; ++j) {
            const double phi = 2 * pi * (j + 0.5) / columns;
            nodes.push_back({Vec3d(sinTheta * std::cos(phi), sinTheta * std::sin(phi), z),
                             row.weight * t * 2 * pi / columns});
        }
    }
    return nodes;
}

}  // namespace prt
