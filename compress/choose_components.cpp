// Search for the number of principal vectors [IwanickiSloan2012, Sec. 6 compares 4, 12 and 24] by what is
// seen.
#include "compress/choose_components.h"

#include <algorithm>

#include "compress/relit_error.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr size_t kProbedPoints = 2048;

std::vector<double> errorsOf(const RelitProbe& probe, const CompressedVisibility& compressed,
                             std::span<const float> rows, size_t columns) {
    const size_t components = size_t(compressed.pca.components);
    std::vector<float> exact, approximate;
    for (const uint32_t point : probe.points()) {
        const float* weights = &compressed.weights[point * components];
        for (size_t c = 0; c < columns; ++c) {
            exact.push_back(rows[point * columns + c]);
            double sum = double(compressed.pca.mean[c]);
            for (size_t m = 0; m < components; ++m)
                sum += double(weights[m]) * double(compressed.pca.basis[m * columns + c]);
            approximate.push_back(float(sum));
        }
    }
    return probe.relativeRmse(exact, approximate);
}

double largest(const std::vector<double>& errors) { return *std::max_element(errors.begin(), errors.end()); }

}  // namespace

std::vector<double> relitErrors(const CompressedVisibility& compressed, std::span<const float> rows,
                                std::span<const uint8_t> use, std::span<const Vec3f> normals, int shOrder,
                                std::span<const EnvironmentSh> environments) {
    return errorsOf(RelitProbe(shOrder, normals, use, environments), compressed, rows,
                    size_t(shCount(shOrder)));
}

ChosenBasis chooseBasis(const VisibilityStatistics& statistics, int shOrder, const Projection& projection,
                        CompressionSettings settings, std::span<const EnvironmentSh> environments,
                        double targetError) {
    PRT_CHECK(targetError > 0);
    const size_t columns = size_t(shCount(shOrder));
    const SampledRows sample = thinned(statistics.sample(), columns, kProbedPoints);
    const RelitProbe probe(shOrder, sample.normals, {}, environments);
    const VisibilityInMemory source(shOrder, {0, sample.rows, sample.normals, {}, {}, {}});
    const auto chosen = [&](int components) {
        throwIfInterrupted();
        settings.components = components;
        CompressedVisibility compressed{statistics.basis(settings), {}};
        compressRows(source, projection, compressed.pca, settings.fit, [&](std::span<const float> weights) {
            compressed.weights.assign(weights.begin(), weights.end());
        });
        std::vector<double> errors = errorsOf(probe, compressed, sample.rows, columns);
        return ChosenBasis{std::move(compressed.pca), std::move(errors)};
    };
    int low = 1;
    ChosenBasis best = chosen(int(columns));
    while (low < best.pca.components) {
        ChosenBasis middle = chosen((low + best.pca.components) / 2);
        if (largest(middle.relitErrors) <= targetError)
            best = std::move(middle);
        else
            low = middle.pca.components + 1;
    }
    return best;
}

}  // namespace prt
