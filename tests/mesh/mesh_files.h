// Small mesh files written by the tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/mesh/load_mesh.h"
#include "tests/base/temporary_directory.h"

namespace prt {

class MeshFiles : public testing::Test {
  protected:
    std::string write(const std::string& name, const std::string& bytes) const {
        const std::string path = directory_.file(name);
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }

    Scene load(const std::string& name, const std::string& bytes, LoadMeshReport* report = nullptr) const {
        return loadMesh(write(name, bytes), {}, report);
    }

    /// what() of the InputError that loading must throw, without the directory's name.
    std::string problemOf(const std::string& name, const std::string& bytes) const {
        return problemOfFile(write(name, bytes));
    }
    std::string problemOfFile(const std::string& path) const {
        try {
            loadMesh(path, {});
        } catch (const InputError& error) {
            std::string what = error.what();
            const std::string prefix = directory_.path().string() + "/";
            if (const size_t at = what.find(prefix); at != what.npos) what.erase(at, prefix.size());
            EXPECT_EQ(what.find('\n'), what.npos) << what;
            // The system's own words on a file that cannot be opened say enough.
            if (error.problem().find("cannot be read") == std::string::npos) {
                EXPECT_FALSE(error.remedy().empty()) << what;
            }
            return what;
        }
        return "no error";
    }

    TemporaryDirectory directory_;
};

/// Bytes of a number, in little or big endian.
template <class T>
std::string rawBytes(T value, bool big = false) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (big) bytes.assign(bytes.rbegin(), bytes.rend());
    return bytes;
}

inline std::string binaryStl(const std::vector<std::vector<float>>& triangles, uint32_t promised) {
    std::string bytes(80, ' ');
    bytes += rawBytes(promised);
    for (const auto& triangle : triangles) {
        for (int i = 0; i < 3; ++i) bytes += rawBytes(0.0f);
        for (float value : triangle) bytes += rawBytes(value);
        bytes += rawBytes(uint16_t(0));
    }
    return bytes;
}

}  // namespace prt
