// Sources: OpenEXR 3.1 (multi-part scanline files, ZIP), "OpenEXR File Layout".
#include "precompute/io/exr_file.h"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfEnvmapAttribute.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <system_error>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"

namespace prt {
namespace fs = std::filesystem;
namespace {

// A damaged header must not make OpenEXR allocate tables or lines of gigabytes.
constexpr int kMaxExrSize = 1 << 17;
constexpr uint64_t kMaxBytesPerChunk = uint64_t(1) << 30;
// zlib reaches 1032 : 1, run lengths of wavelets somewhat more; small files may hold constants.
constexpr uint64_t kMaxCompression = 2000;
constexpr uint64_t kAlwaysAllowedBytes = uint64_t(64) << 20;

void prepareOpenExr() {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    Imf::Header::setMaxImageSize(kMaxExrSize, kMaxExrSize);
    Imf::Header::setMaxTileSize(kMaxExrSize, kMaxExrSize);
    const int threads = threadCount() > 1 ? threadCount() : 0;
    if (Imf::globalThreadCount() != threads) Imf::setGlobalThreadCount(threads);
}

// OpenEXR writes its line table in a destructor, which can't report that the disk is full: this stream
// remembers.
class CheckedStream final : public Imf::OStream {
  public:
    explicit CheckedStream(const fs::path& path)
        : Imf::OStream(path.c_str()), file_(std::fopen(path.c_str(), "wb")) {
        if (!file_) fail();
    }
    ~CheckedStream() override {
        if (file_) std::fclose(file_);
    }
    CheckedStream(const CheckedStream&) = delete;
    CheckedStream& operator=(const CheckedStream&) = delete;

    void write(const char bytes[], int count) override {
        if (!file_ || std::fwrite(bytes, 1, size_t(count), file_) != size_t(count)) fail();
    }
    uint64_t tellp() override {
        const off_t at = file_ ? ::ftello(file_) : -1;
        if (at < 0) fail();
        return uint64_t(at);
    }
    void seekp(uint64_t position) override {
        if (!file_ || ::fseeko(file_, off_t(position), SEEK_SET) != 0) fail();
    }
    /// Closes; throws if any write failed, the ones in destructors included.
    void finish() {
        if (file_ && std::fclose(file_) != 0 && error_ == 0) error_ = errno;
        file_ = nullptr;
        if (error_ != 0) throw std::system_error(error_, std::generic_category());
    }

  private:
    [[noreturn]] void fail() {
        if (error_ == 0) error_ = errno != 0 ? errno : EIO;
        throw std::system_error(error_, std::generic_category());
    }
    std::FILE* file_;
    int error_ = 0;
};

Imf::PixelType pixelType(ExrType type) {
    return type == ExrType::Half ? Imf::HALF : type == ExrType::Uint ? Imf::UINT : Imf::FLOAT;
}

Imf::Header makeHeader(const ExrPartOut& part, const ExrPartOut& first, bool multiPart) {
    const Imath::Box2i display(Imath::V2i(0, 0), Imath::V2i(first.width - 1, first.height - 1));
    const Imath::Box2i data(Imath::V2i(0, 0), Imath::V2i(part.width - 1, part.height - 1));
    Imf::Header header(display, data, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                       part.compression == ExrCompression::Zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION);
    header.setType(Imf::SCANLINEIMAGE);
    if (multiPart) header.setName(part.name);
    for (const auto& [name, value] : part.attributes.strings)
        header.insert(name, Imf::StringAttribute(value));
    for (const auto& [name, value] : part.attributes.ints) header.insert(name, Imf::IntAttribute(value));
    for (const auto& [name, value] : part.attributes.floatVectors)
        header.insert(name, Imf::FloatVectorAttribute(value));
    for (const ExrChannelOut& channel : part.channels)
        header.channels().insert(channel.name, Imf::Channel(pixelType(channel.type)));
    return header;
}

// OpenEXR doesn't convert on writing: rows of half channels pass through this.
class HalfRows {
  public:
    /// Frame buffer of rows that begin with `firstRow`.
    Imf::FrameBuffer convert(const ExrPartOut& part, int firstRow, int rows,
                             const std::vector<ExrChannelOut>& channels) {
        Imf::FrameBuffer frame;
        size_t buffer = 0;
        const size_t width = size_t(part.width);
        // OpenEXR addresses rows from the top of the image.
        const Imath::Box2i window(Imath::V2i(0, firstRow), Imath::V2i(part.width - 1, firstRow + rows - 1));
        for (const ExrChannelOut& channel : channels) {
            const char* base = static_cast<const char*>(channel.data);
            if (channel.type != ExrType::Half) {
                frame.insert(channel.name, Imf::Slice::Make(pixelType(channel.type), base, window,
                                                            channel.xStride, channel.yStride));
                continue;
            }
            if (buffer == buffers_.size()) buffers_.emplace_back();
            std::vector<half>& halves = buffers_[buffer++];
            halves.resize(size_t(rows) * width);
            for (size_t y = 0; y < size_t(rows); ++y)
                for (size_t x = 0; x < width; ++x) {
                    float value;
                    std::memcpy(&value, base + y * channel.yStride + x * channel.xStride, 4);
                    halves[y * width + x] = half(value);
                }
            frame.insert(channel.name, Imf::Slice::Make(Imf::HALF, halves.data(), window));
        }
        return frame;
    }

  private:
    std::vector<std::vector<half>> buffers_;
};

// Calls body; what OpenEXR throws comes out as an OutputError.
template <class Body>
void translateOutput(const fs::path& path, const Body& body) {
    try {
        body();
    } catch (const Error&) {
        throw;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& problem) {
        throw OutputError(path.string(), fmt::format("cannot be written: {}", problem.what()),
                          "is the disk full?");
    }
}

}  // namespace

struct ExrWriter::State {
    fs::path path;
    std::vector<ExrPartOut> parts;
    std::vector<int> written;  // rows of each part
    HalfRows halfRows;
    AtomicFile atomic;
    std::unique_ptr<CheckedStream> stream;
    std::unique_ptr<Imf::MultiPartOutputFile> file;

    State(const fs::path& destination, const std::vector<ExrPartOut>& description)
        : path(destination), parts(description), written(description.size(), 0), atomic(destination) {}
};

ExrWriter::ExrWriter(const fs::path& path, const std::vector<ExrPartOut>& parts) {
    PRT_CHECK(!parts.empty());
    for (const ExrPartOut& part : parts) {
        PRT_CHECK(part.width > 0 && part.height > 0 && !part.channels.empty());
        if (part.width > kMaxExrSize || part.height > kMaxExrSize)
            throw OutputError(path.string(), fmt::format("{} x {} pixels are more than {} in a direction",
                                                         part.width, part.height, kMaxExrSize));
    }
    state_ = std::make_unique<State>(path, parts);
    translateOutput(path, [&] {
        prepareOpenExr();
        std::vector<Imf::Header> headers;
        for (const ExrPartOut& part : parts) headers.push_back(makeHeader(part, parts[0], parts.size() > 1));
        state_->stream = std::make_unique<CheckedStream>(state_->atomic.temporaryPath());
        state_->file =
            std::make_unique<Imf::MultiPartOutputFile>(*state_->stream, headers.data(), int(headers.size()));
    });
}

ExrWriter::~ExrWriter() = default;

void ExrWriter::writeRows(size_t part, int rows, const std::vector<ExrChannelOut>& channels) {
    PRT_CHECK_LT(part, state_->parts.size());
    const ExrPartOut& description = state_->parts[part];
    int& written = state_->written[part];
    PRT_CHECK_LE(written + rows, description.height);
    PRT_CHECK_EQ(channels.size(), description.channels.size());
    translateOutput(state_->path, [&] {
        Imf::OutputPart out(*state_->file, int(part));
        // Every thread compresses a chunk at a time; between calls, Ctrl-C is heard.
        const int step = kExrChunkRows * std::max(2, threadCount());
        for (int y = 0; y < rows; y += step) {
            throwIfInterrupted();
            const int count = std::min(step, rows - y);
            std::vector<ExrChannelOut> from = channels;
            for (ExrChannelOut& channel : from)
                channel.data = static_cast<const char*>(channel.data) + size_t(y) * channel.yStride;
            out.setFrameBuffer(state_->halfRows.convert(description, written, count, from));
            out.writePixels(count);
            written += count;
        }
    });
}

void ExrWriter::commit() {
    for (size_t part = 0; part < state_->parts.size(); ++part)
        PRT_CHECK_EQ(state_->written[part], state_->parts[part].height);
    translateOutput(state_->path, [&] {
        state_->file.reset();  // writes the table of lines
        state_->stream->finish();
    });
    state_->atomic.commit();
}

void writeExr(const fs::path& path, const std::vector<ExrPartOut>& parts) {
    ExrWriter writer(path, parts);
    uint64_t rows = 0;
    for (const ExrPartOut& part : parts) rows += uint64_t(part.height);
    Progress progress("writing", rows, "rows");
    const int step = kExrChunkRows * std::max(2, threadCount());
    for (size_t i = 0; i < parts.size(); ++i)
        for (int y = 0; y < parts[i].height; y += step) {
            const int count = std::min(step, parts[i].height - y);
            std::vector<ExrChannelOut> channels = parts[i].channels;
            for (ExrChannelOut& channel : channels)
                channel.data = static_cast<const char*>(channel.data) + size_t(y) * channel.yStride;
            writer.writeRows(i, count, channels);
            progress.advance(uint64_t(count));
        }
    writer.commit();
}

namespace {

uint64_t rowsPerChunk(Imf::Compression compression) {
    switch (compression) {
        case Imf::NO_COMPRESSION:
        case Imf::RLE_COMPRESSION:
        case Imf::ZIPS_COMPRESSION:
            return 1;
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return 16;
        case Imf::DWAB_COMPRESSION:
            return 256;
        default:
            return 32;
    }
}

void checkPart(const Imf::Header& header, const std::string& path, uint64_t fileBytes) {
    if (header.hasType() && Imf::isDeepData(header.type()))
        throw InputError(path, "holds deep pixels", "flatten the image");
    const Imath::Box2i window = header.dataWindow();
    const int64_t width = int64_t(window.max.x) - window.min.x + 1;
    const int64_t height = int64_t(window.max.y) - window.min.y + 1;
    if (width < 1 || height < 1 || width > kMaxExrSize || height > kMaxExrSize)
        throw InputError(path, fmt::format("has an impossible size of {} x {} pixels", width, height));
    uint64_t bytesPerPixel = 0;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
        bytesPerPixel += channel.channel().type == Imf::HALF ? 2 : 4;
    const uint64_t bytes = uint64_t(width) * uint64_t(height) * bytesPerPixel;
    if (bytes > std::max(fileBytes * kMaxCompression, kAlwaysAllowedBytes))
        throw InputError(path,
                         fmt::format("promises {} bytes of pixels in a file of {} bytes", bytes, fileBytes),
                         "the file is damaged");
    if (uint64_t(width) * bytesPerPixel * rowsPerChunk(header.compression()) > kMaxBytesPerChunk)
        throw InputError(path, "has rows too long to be read", "save it with ZIP compression");
}

ExrPartInfo describePart(const Imf::Header& header) {
    ExrPartInfo info;
    if (header.hasName()) info.name = header.name();
    const Imath::Box2i window = header.dataWindow();
    info.width = window.max.x - window.min.x + 1;
    info.height = window.max.y - window.min.y + 1;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
        const Imf::Channel& channel = it.channel();
        if (channel.xSampling != 1 || channel.ySampling != 1) continue;
        info.channels[it.name()] = channel.type == Imf::HALF   ? ExrType::Half
                                   : channel.type == Imf::UINT ? ExrType::Uint
                                                               : ExrType::Float;
    }
    for (auto it = header.begin(); it != header.end(); ++it) {
        const Imf::Attribute& attribute = it.attribute();
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute))
            info.attributes.strings[it.name()] = text->value();
        else if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(&attribute))
            info.attributes.ints[it.name()] = number->value();
        else if (const auto* numbers = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute))
            info.attributes.floatVectors[it.name()] = numbers->value();
    }
    if (Imf::hasEnvmap(header))
        info.envmap = Imf::envmap(header) == Imf::ENVMAP_CUBE ? ExrEnvmap::Cube : ExrEnvmap::LatLong;
    return info;
}

[[noreturn]] void throwDamaged(const std::string& path, const std::exception& problem) {
    // OpenEXR begins its messages with the file's name, which the error has already.
    std::string what = problem.what();
    const size_t at = what.find(path);
    if (at != std::string::npos && at + path.size() + 2 < what.size()) {
        what = what.substr(at + path.size());
        what.erase(0, what.find_first_not_of("\".: "));
    }
    throw InputError(path, fmt::format("is damaged or not an OpenEXR file ({})", what));
}

}  // namespace

struct ExrReader::File {
    std::unique_ptr<Imf::MultiPartInputFile> file;
};

ExrReader::ExrReader(const fs::path& path) : path_(path.string()), file_(std::make_unique<File>()) {
    std::error_code problem;
    if (fs::is_directory(path, problem)) throw InputError(path_, "is a directory", "name a file");
    const uint64_t bytes = fs::file_size(path, problem);
    if (problem) throw InputError(path_, fmt::format("cannot be read: {}", problem.message()));
    try {
        prepareOpenExr();
        // No search for missing lines: an incomplete file is refused anyway.
        file_->file =
            std::make_unique<Imf::MultiPartInputFile>(path.c_str(), Imf::globalThreadCount(), false);
        for (int i = 0; i < file_->file->parts(); ++i) {
            checkPart(file_->file->header(i), path_, bytes);
            parts_.push_back(describePart(file_->file->header(i)));
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception& problemFound) {
        throwDamaged(path_, problemFound);
    }
}

ExrReader::~ExrReader() = default;

void ExrReader::read(size_t part, const std::vector<ExrChannelIn>& channels) const {
    PRT_CHECK_LT(part, parts_.size());
    const int step = 256, height = parts_[part].height;
    for (int y = 0; y < height; y += step) {
        std::vector<ExrChannelIn> rows = channels;
        for (ExrChannelIn& channel : rows)
            channel.data = static_cast<char*>(channel.data) + size_t(y) * channel.yStride;
        readRows(part, y, std::min(step, height - y), rows);
    }
}

void ExrReader::readRows(size_t part, int firstRow, int rows,
                         const std::vector<ExrChannelIn>& channels) const {
    PRT_CHECK_LT(part, parts_.size());
    const ExrPartInfo& info = parts_[part];
    PRT_CHECK_LE(0, firstRow);
    PRT_CHECK_LE(1, rows);
    PRT_CHECK_LE(firstRow + rows, info.height);
    for (const ExrChannelIn& channel : channels)
        if (!info.channels.contains(channel.name))
            throw InputError(path_, fmt::format("has no channel {}", channel.name));
    throwIfInterrupted();
    try {
        const Imath::V2i first = file_->file->header(int(part)).dataWindow().min + Imath::V2i(0, firstRow);
        Imf::FrameBuffer frame;
        for (const ExrChannelIn& channel : channels)
            frame.insert(channel.name, Imf::Slice::Make(pixelType(channel.type), channel.data, first,
                                                        info.width, rows, channel.xStride, channel.yStride));
        Imf::InputPart in(*file_->file, int(part));
        in.setFrameBuffer(frame);
        in.readPixels(first.y, first.y + rows - 1);
    } catch (const std::exception& problem) {
        throwDamaged(path_, problem);
    }
}

}  // namespace prt
