// The library against values derived in exact arithmetic by tools/generate_sh_reference.py.
#include "tests/math/sh_reference.h"

#include <cmath>
#include <vector>

#include "precompute/math/basis_conversion.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "precompute/math/sh_rotation.h"

namespace prt::test {
namespace {

constexpr int kExpansionCount = shCount(kReferenceExpansionOrder);

template <typename Values>
void expectValues(const Values& values, const double* expected, size_t count, double tolerance) {
    ASSERT_EQ(size_t(values.size()), count);
    for (size_t i = 0; i < count; ++i) EXPECT_NEAR(double(values[i]), expected[i], tolerance) << i;
}

TEST(ShReference, Evaluation) {
    constexpr size_t kCount = size_t(shCount(kReferenceShOrder));
    for (int k = 0; k < kReferenceDirections; ++k) {
        const Vec3d direction(kReferenceDirection[3 * k], kReferenceDirection[3 * k + 1],
                              kReferenceDirection[3 * k + 2]);
        std::vector<double> values(kCount);
        evalSh(kReferenceShOrder, direction, std::span<double>(values));
        expectValues(values, kReferenceSh + size_t(k) * kCount, kCount, 1e-13);
        std::vector<float> single(kCount);
        const Vec3f rounded = direction.cast<float>();
        evalSh(kReferenceShOrder, rounded, std::span<float>(single));
        expectValues(single, kReferenceSh + size_t(k) * kCount, kCount,
                     2e-5);  // of the rounded direction too
    }
}

TEST(ShReference, Rotation) {
    Mat3d rotation;
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = kReferenceRotation[i];
    std::vector<double> rotated(kExpansionCount);
    rotateSh(rotation, kReferenceExpansionOrder, std::span<const double>(kReferenceF),
             std::span<double>(rotated));
    expectValues(rotated, kReferenceRotated, rotated.size(), 1e-13);
}

TEST(ShReference, Product) {
    const std::vector<float> f(std::begin(kReferenceF), std::end(kReferenceF));
    const std::vector<float> g(std::begin(kReferenceG), std::end(kReferenceG));
    const std::vector<float> product = shProduct(f, g, kReferenceExpansionOrder);
    expectValues(product, kReferenceProduct, product.size(), 5e-6);
    std::vector<float> byCode(product.size());
    shProduct(kReferenceExpansionOrder, f, g, byCode);
    expectValues(byCode, kReferenceProduct, byCode.size(), 5e-6);
}

TEST(ShReference, ConversionToTheHBasis) {
    const std::vector<double> matrix = shToHMatrix(kReferenceTOrder);
    expectValues(matrix, kReferenceT, std::size(kReferenceT), 1e-13);
}

TEST(ShReference, ConversionToHemisphericalHarmonics) {
    const std::vector<double> matrix = shToHshMatrix(kReferenceCOrder, kReferenceCOrder);
    expectValues(matrix, kReferenceC, std::size(kReferenceC), 1e-13);
}

TEST(ShReference, ClampedCosine) {
    for (int l = 0; l < kMaxShOrder; ++l)
        EXPECT_NEAR(clampedCosineBand(l), kReferenceClampedCosine[l], 1e-15) << l;
}

}  // namespace
}  // namespace prt::test
