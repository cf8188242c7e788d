// Random contents of the files of a bundle.
#pragma once

#include <random>

#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"

namespace prt {

inline std::vector<float> randomFloats(size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> gauss;
    std::vector<float> values(count);
    for (float& value : values) value = gauss(random);
    return values;
}

inline VisibilityMap randomVisibility(const PointGrid& grid, int shOrder) {
    VisibilityMap map;
    map.grid = grid;
    map.shOrder = shOrder;
    map.coefficients = randomFloats(grid.count * size_t(shOrder) * size_t(shOrder), 1);
    map.ao = randomFloats(grid.count, 2);
    const std::vector<float> normals = randomFloats(grid.count * 3, 3);
    for (size_t i = 0; i < grid.count; ++i) {
        map.normals.emplace_back(normals[i * 3], normals[i * 3 + 1], normals[i * 3 + 2]);
        map.validity.push_back(Validity(i % size_t(kValidityCount)));
    }
    map.attributes = {{"rays", "1024"}, {"note", ""}};
    return map;
}

inline PcaMap randomPca(const PointGrid& grid, int shOrder, int components) {
    const size_t coefficients = size_t(shOrder) * size_t(shOrder);
    PcaMap map;
    map.grid = grid;
    map.shOrder = shOrder;
    map.components = components;
    map.mean = randomFloats(coefficients, 1);
    map.basis = randomFloats(coefficients * size_t(components), 2);
    map.weights = randomFloats(grid.count * size_t(components), 3);
    map.variance = randomFloats(size_t(components), 4);
    map.attributes = {{"metric", "plain least squares"}};
    return map;
}

inline NormalTable randomTable(TableKind kind, int size, int shOrder, int layers) {
    NormalTable table;
    table.kind = kind;
    table.size = size;
    table.shOrder = shOrder;
    table.layers = layers;
    table.values = randomFloats(size_t(3) * size_t(layers) * table.texels(), 5);
    table.attributes = {{"environment", "night"}, {"cosineModel", "exact"}};
    return table;
}

}  // namespace prt
