// Bundles to export, and what became of them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include "compress/compress_job.h"
#include "compress/export_bundle.h"
#include "compress/tabulate_job.h"
#include "precompute/base/atomic_file.h"
#include "precompute/io/bundle.h"
#include "precompute/io/sun_shadow_file.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/small_maps.h"

namespace prt {

using nlohmann::json;
namespace fs = std::filesystem;

inline const PointGrid kAtlas{PointDomain::Texel, 24, 20, 480};

// A baked look: smooth in a few dimensions, open by a half, coefficients falling with the band.
inline VisibilityMap bakedVisibility(const PointGrid& grid, int shOrder) {
    VisibilityMap map = randomVisibility(grid, shOrder);
    const auto n2 = size_t(shOrder) * size_t(shOrder);
    for (size_t i = 0; i < grid.count; ++i) {
        map.normals[i].normalize();
        if (map.validity[i] == Validity::Inside) map.validity[i] = Validity::Valid;
        for (size_t k = 0; k < n2; ++k) {
            float& value = map.coefficients[i * n2 + k];
            value = map.validity[i] == Validity::Empty
                        ? 0.0f
                        : 0.2f * value / (1 + float(k)) + (k == 0 ? 1.8f : 0.0f);
        }
    }
    map.projection = kPlainProjection;
    return map;
}

class Export : public testing::Test {
  protected:
    void writeBundle(const VisibilityMap& map, int components) {
        BundleTransaction transaction(bundle(), true);
        writeVisibilityFile(transaction.stage("visibility.exr", {}, "prt precompute thing.obj").string(),
                            map);
        transaction.commit();
        if (components == 0) return;
        CompressSettings settings;
        settings.bundlePath = bundle();
        settings.components = components;
        runCompress(settings);
    }
    // A sun with shadows of its own beside the tables.
    SunShadowMap addSun(const PointGrid& grid) const {
        SunShadowMap sun;
        sun.grid = grid;
        sun.direction = Vec3f(0.6f, 0.8f, 0);
        sun.angularRadiusRad = 0.01f;
        sun.irradiance = {3, 2.5f, 1};
        for (size_t i = 0; i < grid.count; ++i) sun.shadow.push_back(float(i % 256) / 255);
        sun.attributes = {{"environmentName", "noon"}};
        BundleTransaction transaction(bundle(), false);
        writeSunShadowFile(transaction.stage(sunShadowFileName("noon"), {}, "prt tabulate noon").string(),
                           sun);
        transaction.commit();
        return sun;
    }
    void tabulate(const std::string& kind) const {
        TabulateSettings settings;
        settings.bundlePath = bundle();
        settings.environments = {"sky:clear"};
        settings.kind = kind;
        settings.table.size = 8;
        runTabulate(settings);
    }
    ExportSettings settings() const {
        ExportSettings result;
        result.bundlePath = bundle();
        result.folder = out().string();
        return result;
    }
    json description() const { return json::parse(readFile(out() / "thing.json")); }
    std::string bundle() const { return directory_.file("thing.prt"); }
    fs::path out() const { return directory_.path() / "out"; }

    TemporaryDirectory directory_;
};

}  // namespace prt
