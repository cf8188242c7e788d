// Radiance RGBE. Our own, because the packaged stb_image repeats a truncated run for ever and takes the
// missing end of a flat file for black. Sources: G. Ward, "Real Pixels", Graphics Gems II (1991); Radiance
// file formats reference, "picture files".
#include "precompute/io/rgbe.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "precompute/base/error.h"

namespace prt {
namespace {

constexpr int kMaxSize = 16384;

class RgbeReader {
  public:
    RgbeReader(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(where) {}

    FloatImage read() {
        readHeader();
        FloatImage image{width_, height_, 3, {}};
        // A row of runs takes at least 4 bytes and then 2 per 127 texels and channel.
        const size_t least = width_ >= 8 ? 4 : 1;
        if ((bytes_.size() - at_) / least < size_t(height_)) throwTruncated();
        image.pixels.resize(size_t(width_) * size_t(height_) * 3);
        std::vector<uint8_t> row(size_t(width_) * 4);
        for (int y = 0; y < height_; ++y) {
            readRow(row);
            for (size_t x = 0; x < size_t(width_); ++x) {
                const int exponent = row[x * 4 + 3];
                const float scale = exponent ? std::ldexp(1.0f, exponent - (128 + 8)) : 0.0f;
                for (size_t c = 0; c < 3; ++c) image.at(int(x), y)[c] = float(row[x * 4 + c]) * scale;
            }
        }
        return image;
    }

  private:
    [[noreturn]] void throwTruncated() const {
        throw InputError(where_, fmt::format("ends after {} bytes, before its last pixel", bytes_.size()),
                         "fetch the file again");
    }
    uint8_t next() {
        if (at_ >= bytes_.size()) throwTruncated();
        return uint8_t(bytes_[at_++]);
    }
    std::string_view nextLine() {
        const size_t end = bytes_.find('\n', at_);
        if (end == std::string_view::npos) throw InputError(where_, "damaged header of a Radiance image");
        std::string_view line = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        return line;
    }

    void readHeader() {
        const std::string_view magic = nextLine();
        if (!magic.starts_with("#?")) throw InputError(where_, "not a Radiance image");
        bool known = false;
        for (std::string_view line = nextLine(); !line.empty(); line = nextLine())
            if (line.starts_with("FORMAT=")) {
                known = line == "FORMAT=32-bit_rle_rgbe";
                if (!known)
                    throw InputError(where_, fmt::format("has pixels of {}", line.substr(7)), "save as RGBE");
            }
        if (!known) throw InputError(where_, "Radiance image without a format line");
        const std::string_view size = nextLine();
        const size_t gap = size.find(" +X ");
        if (!size.starts_with("-Y ") || gap == std::string_view::npos)
            throw InputError(where_, fmt::format("has the orientation \"{}\"", size), "save it as -Y N +X M");
        height_ = number(size.substr(3, gap - 3));
        width_ = number(size.substr(gap + 4));
        if (width_ > kMaxSize || height_ > kMaxSize)
            throw InputError(where_,
                             fmt::format("{} x {} pixels are more than {}", width_, height_, kMaxSize),
                             "scale it down");
    }
    int number(std::string_view text) const {
        int value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size() || value < 1)
            throw InputError(where_, "Radiance image with a damaged size");
        return value;
    }

    void readRow(std::vector<uint8_t>& row) {
        std::array<uint8_t, 4> first{};
        for (uint8_t& byte : first) byte = next();
        const bool runs = width_ >= 8 && width_ < 32768 && first[0] == 2 && first[1] == 2 && first[2] < 128;
        if (!runs) return readOldRow(row, first);
        if (first[2] * 256 + first[3] != width_) throw InputError(where_, "damaged row of a Radiance image");
        for (size_t channel = 0; channel < 4; ++channel) readRuns(row, channel);
    }
    void readRuns(std::vector<uint8_t>& row, size_t channel) {
        const size_t width = size_t(width_);
        for (size_t x = 0; x < width;) {
            size_t count = next();
            const bool run = count > 128;
            if (run) count -= 128;
            if (count == 0 || count > width - x) throw InputError(where_, "damaged run of a Radiance image");
            const uint8_t value = run ? next() : uint8_t(0);
            for (size_t i = 0; i < count; ++i, ++x) row[x * 4 + channel] = run ? value : next();
        }
    }
    // Four bytes per texel; (1, 1, 1, n) repeats the texel before n times, the next such 256 n times, …
    void readOldRow(std::vector<uint8_t>& row, std::array<uint8_t, 4> texel) {
        const size_t width = size_t(width_);
        int shift = 0;
        for (size_t x = 0; x < width;) {
            if (texel[0] == 1 && texel[1] == 1 && texel[2] == 1) {
                const size_t count = shift < 24 ? size_t(texel[3]) << shift : 0;
                if (x == 0 || count > width - x || shift >= 24)
                    throw InputError(where_, "damaged run of a Radiance image");
                for (size_t i = 0; i < count; ++i, ++x)
                    for (size_t c = 0; c < 4; ++c) row[x * 4 + c] = row[(x - 1) * 4 + c];
                shift += 8;
            } else {
                for (size_t c = 0; c < 4; ++c) row[x * 4 + c] = texel[c];
                ++x;
                shift = 0;
            }
            if (x < width)
                for (uint8_t& byte : texel) byte = next();
        }
    }

    std::string_view bytes_;
    std::string where_;
    size_t at_ = 0;
    int width_ = 0, height_ = 0;
};

}  // namespace

FloatImage decodeRgbe(std::string_view bytes, const std::string& where) {
    return RgbeReader(bytes, where).read();
}

}  // namespace prt
