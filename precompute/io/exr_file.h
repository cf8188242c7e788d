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

enum class ExrCompression { Zip, None };

struct ExrPartOut {
    std::string name;  ///< needed when there are several parts
    int width = 0, height = 0;
    std::vector<ExrChannelOut> channels;
    ExrAttributes attributes;
    ExrCompression compression = ExrCompression::Zip;
};

/// Scanlines that ZIP compresses together: rows are read and written fastest in multiples of it.
inline constexpr int kExrChunkRows = 16;

/// A file that is written some rows at a time and appears whole or not at all. Memory: what the rows of a
/// call take, and one chunk per thread.
class ExrWriter {
  public:
    /// @param parts  data of their channels is not looked at. All share the display window of the first
    /// @throws OutputError  cannot be written, or sides too long
    ExrWriter(const std::filesystem::path& path, const std::vector<ExrPartOut>& parts);
    ~ExrWriter();
    ExrWriter(const ExrWriter&) = delete;
    ExrWriter& operator=(const ExrWriter&) = delete;

    /// The next rows of a part, from its top. Parts may take turns.
    /// @param channels  all of the part's; data points at the first of these rows
    /// @throws OutputError, Interrupted
    void writeRows(size_t part, int rows, const std::vector<ExrChannelOut>& channels);
    /// After the last row of every part; without it no file appears.
    /// @throws OutputError
    void commit();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Writes scanlines from the top, all or nothing. All parts share the display window of the first.
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
    /// Rows firstRow … firstRow + rows − 1, counted from the top; data points at the first of them. Whole
    /// chunks are decoded: multiples of kExrChunkRows waste nothing in files of ours.
    /// @throws as read
    void readRows(size_t part, int firstRow, int rows, const std::vector<ExrChannelIn>& channels) const;

  private:
    struct File;
    std::string path_;
    std::unique_ptr<File> file_;
    std::vector<ExrPartInfo> parts_;
};

}  // namespace prt
