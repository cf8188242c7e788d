// Bundles of small made-up visibility in a directory of their own.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "compress/tabulate_job.h"
#include "precompute/io/bundle.h"
#include "precompute/io/image.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/sh.h"

namespace prt {

namespace fs = std::filesystem;

// Smooth coefficients of a few dimensions, validity of every kind.
inline VisibilityMap testVisibility(int shOrder, unsigned seed, int width = 24, int height = 20) {
    VisibilityMap map;
    map.grid = {PointDomain::Texel, width, height, size_t(width * height)};
    map.shOrder = shOrder;
    const size_t n2 = size_t(shCount(shOrder));
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    for (size_t i = 0; i < map.grid.count; ++i) {
        map.validity.push_back(Validity(i % 5));
        map.ao.push_back(0.5f);
        map.normals.push_back(Vec3f(normal(random), normal(random), normal(random)).normalized());
        for (size_t k = 0; k < n2; ++k)
            map.coefficients.push_back(map.validity[i] == Validity::Empty ? 0.0f
                                                                          : normal(random) / float(k + 1));
    }
    map.projection = kPlainProjection;
    map.attributes = {{"rays", "1024"}};
    return map;
}

class Jobs : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "prt-jobs-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        directory_ = pattern;
        bundle_ = (directory_ / "thing.prt").string();
    }
    void TearDown() override { fs::remove_all(directory_); }

    void writeBundle(const VisibilityMap& map) {
        BundleTransaction transaction(bundle_, true);
        const fs::path staged = transaction.stage("visibility.exr", {}, "prt precompute thing.obj");
        writeVisibilityFile(staged.string(), map);
        transaction.commit();
    }
    // Every file below the bundle and its bytes.
    std::map<std::string, std::string> contents() const {
        std::map<std::string, std::string> result;
        for (const auto& entry : fs::recursive_directory_iterator(bundle_)) {
            if (!entry.is_regular_file()) continue;
            std::ifstream file(entry.path(), std::ios::binary);
            std::ostringstream bytes;
            bytes << file.rdbuf();
            result[fs::relative(entry.path(), bundle_).string()] = bytes.str();
        }
        return result;
    }
    // An environment whose radiance is `level` everywhere.
    std::string writeEnvironment(const std::string& name, float level) const {
        const fs::path path = directory_ / name;
        fs::create_directories(path.parent_path());
        writeExrImage(path.string(), {16, 8, 3, std::vector<float>(16 * 8 * 3, level)});
        return path.string();
    }
    TabulateSettings tabulate(std::vector<std::string> environments, std::string kind) const {
        return {bundle_, std::move(environments), std::move(kind), {"cube", 8}};
    }
    template <class Failure, class Run>
    void expectRefused(const Run& run, const std::vector<std::string>& words) const {
        const auto before = contents();
        try {
            run();
            FAIL() << "was not refused";
        } catch (const Failure& error) {
            for (const std::string& word : words) EXPECT_THAT(error.what(), testing::HasSubstr(word));
            EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
        }
        EXPECT_EQ(contents(), before);
    }

    fs::path directory_;
    std::string bundle_;
};

}  // namespace prt
