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

constexpr size_t kMostSampleRows = 20000;

// Every k-th of the rows in use.
struct Sample {
    std::vector<float> rows;
    std::vector<Vec3f> normals;

    Sample(std::span<const float> all, std::span<const uint8_t> use, std::span<const Vec3f> allNormals,
           size_t columns) {
        std::vector<size_t> indices;
        for (size_t i = 0; i < allNormals.size(); ++i)
            if (use.empty() || use[i]) indices.push_back(i);
        const size_t step = std::max<size_t>(1, (indices.size() + kMostSampleRows - 1) / kMostSampleRows);
        for (size_t k = 0; k < indices.size(); k += step) {
            const std::span<const float> row = all.subspan(indices[k] * columns, columns);
            rows.insert(rows.end(), row.begin(), row.end());
            normals.push_back(allNormals[indices[k]]);
        }
    }
};

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

// On the sample alone.
int leastComponents(const Sample& sample, int shOrder, const Projection& projection, WeightsFit fit,
                    std::span<const EnvironmentSh> environments, double targetError) {
    const size_t columns = size_t(shCount(shOrder));
    const RelitProbe probe(shOrder, sample.normals, {}, environments);
    int low = 1, high = int(columns);
    while (low < high) {
        throwIfInterrupted();
        const int middle = (low + high) / 2;
        const CompressedVisibility compressed =
            compressVisibility(sample.rows, {}, sample.normals, shOrder, projection, middle, fit);
        if (largest(errorsOf(probe, compressed, sample.rows, columns)) <= targetError)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

}  // namespace

std::vector<double> relitErrors(const CompressedVisibility& compressed, std::span<const float> rows,
                                std::span<const uint8_t> use, std::span<const Vec3f> normals, int shOrder,
                                std::span<const EnvironmentSh> environments) {
    return errorsOf(RelitProbe(shOrder, normals, use, environments), compressed, rows,
                    size_t(shCount(shOrder)));
}

ChosenCompression compressToError(std::span<const float> rows, std::span<const uint8_t> use,
                                  std::span<const Vec3f> normals, int shOrder, const Projection& projection,
                                  WeightsFit fit, std::span<const EnvironmentSh> environments,
                                  double targetError) {
    PRT_CHECK(targetError > 0);
    const size_t columns = size_t(shCount(shOrder));
    PRT_CHECK_EQ(rows.size(), normals.size() * columns);
    const Sample sample(rows, use, normals, columns);
    int components = sample.normals.empty()
                         ? 1
                         : leastComponents(sample, shOrder, projection, fit, environments, targetError);
    const RelitProbe probe(shOrder, normals, use, environments);
    for (;; ++components) {
        throwIfInterrupted();
        ChosenCompression result{compressVisibility(rows, use, normals, shOrder, projection, components, fit),
                                 {}};
        result.relitErrors = errorsOf(probe, result.compressed, rows, columns);
        if (components == int(columns) || largest(result.relitErrors) <= targetError) return result;
    }
}

}  // namespace prt
