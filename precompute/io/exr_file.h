// OpenEXR files as named channels over plain memory: the only door of this folder to the OpenEXR library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace prt {

enum class ExrType { Half, Float, Uint };

/// Attributes of a part, by type.
struct ExrAttributes {
    std::map<std::string, std::string> strings;
    std::map<std::string, int> ints;
    std::map<std::string, std::vector<float>> floatVectors;
};

/// A channel to write: float (also for Half) or uint32 values at data + y·yStride + x·xStride (bytes).
struct ExrChannelOut {
    std::string name;
    ExrType type = ExrType::Float;
    const void* data = nullptr;
    size_t xStride = 4, yStride = 0;
};

struct ExrPartOut {
    std::string name;  ///< needed when there are several parts
    int width = 0, height = 0;
    std::vector<ExrChannelOut> channels;
    ExrAttributes attributes;
};

/// Writes scanlines from the top with ZIP compression, all or nothing. All parts share the display window of
/// the first.
/// @throws OutputError, Interrupted
void writeExr(const std::filesystem::path& path, const std::vector<ExrPartOut>& parts);

enum class ExrEnvmap { None, LatLong, Cube };

struct ExrPartInfo {
    std::string name;
    int width = 0, height = 0;                ///< of the data window
    std::map<std::string, ExrType> channels;  ///< those at full resolution
    ExrAttributes attributes;
    ExrEnvmap envmap = ExrEnvmap::None;
};

/// A channel to read, converted to float or uint32. Rows from the top of the data window, whatever its
/// offset.
struct ExrChannelIn {
    std::string name;
    ExrType type = ExrType::Float;  ///< of the memory: Float or Uint
    void* data = nullptr;
    size_t xStride = 4, yStride = 0;
};

/// An open file, whose headers were found to be sane: sizes are bounded by what so many bytes can hold.
class ExrReader {
  public:
    /// @throws InputError  missing, damaged, deep data, absurd sizes
    explicit ExrReader(const std::filesystem::path& path);
    ~ExrReader();
    ExrReader(const ExrReader&) = delete;
    ExrReader& operator=(const ExrReader&) = delete;

    const std::vector<ExrPartInfo>& parts() const { return parts_; }
    /// @throws InputError  a channel that the part doesn't have (named), damaged pixels; Interrupted
    void read(size_t part, const std::vector<ExrChannelIn>& channels) const;

  private:
    struct File;
    std::string path_;
    std::unique_ptr<File> file_;
    std::vector<ExrPartInfo> parts_;
};

}  // namespace prt
