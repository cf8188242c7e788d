// Text by the bitmap font of stb_easy_font.h.
#include "tools/measure/compression_sheet.h"

#include <stb_easy_font.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "precompute/base/check.h"

namespace prt::tools {
namespace {

constexpr int kMargin = 8, kLabel = 26, kTextScale = 2;
constexpr std::array<uint8_t, 3> kPaper{32, 32, 34}, kInk{240, 240, 240};
constexpr size_t kVertexBytes = 16, kBytesPerCharacter = 512;

void fill(ByteImage& image, int x0, int y0, int x1, int y1, const std::array<uint8_t, 3>& colour) {
    for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
        for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x)
            std::copy(colour.begin(), colour.end(),
                      image.pixels.begin() + 3 * (ptrdiff_t(y) * image.width + x));
}

// The corner of a quad at an index of the font's vertices.
std::array<float, 2> corner(const std::vector<char>& vertices, size_t index) {
    std::array<float, 2> xy;
    std::memcpy(xy.data(), &vertices[index * kVertexBytes], sizeof xy);
    return xy;
}

void drawText(ByteImage& image, int left, int top, int width, std::string text) {
    std::vector<char> vertices(kBytesPerCharacter * (text.size() + 1));
    const int quads = stb_easy_font_print(0, 0, text.data(), nullptr, vertices.data(), int(vertices.size()));
    for (int q = 0; q < quads; ++q) {
        const auto low = corner(vertices, 4 * size_t(q)), high = corner(vertices, 4 * size_t(q) + 2);
        const int right = std::min(left + kTextScale * int(high[0]), left + width);
        fill(image, left + kTextScale * int(low[0]), top + kTextScale * int(low[1]), right,
             top + kTextScale * int(high[1]), kInk);
    }
}

}  // namespace

ByteImage composeSheet(const std::string& title, const std::vector<std::vector<SheetCell>>& rows) {
    int width = 0, height = 0, noteHeight = 0;
    size_t columns = 0;
    for (const auto& row : rows) {
        columns = std::max(columns, row.size());
        for (const SheetCell& cell : row) {
            PRT_CHECK(cell.image.pixels.empty() || cell.image.channels == 3);
            width = std::max(width, cell.image.width);
            height = std::max(height, cell.image.height);
            if (!cell.note.empty()) noteHeight = kLabel;
        }
    }
    PRT_CHECK_LT(0, width);
    ByteImage sheet{int(columns) * (width + kMargin) + kMargin,
                    kLabel + int(rows.size()) * (height + kLabel + noteHeight + kMargin) + kMargin,
                    3,
                    {}};
    sheet.pixels.resize(size_t(sheet.width) * size_t(sheet.height) * 3);
    fill(sheet, 0, 0, sheet.width, sheet.height, kPaper);
    drawText(sheet, kMargin, kMargin, sheet.width - 2 * kMargin, title);
    for (size_t r = 0; r < rows.size(); ++r)
        for (size_t c = 0; c < rows[r].size(); ++c) {
            const SheetCell& cell = rows[r][c];
            const int x = kMargin + int(c) * (width + kMargin);
            const int y = kLabel + kMargin + int(r) * (height + kLabel + noteHeight + kMargin);
            drawText(sheet, x, y, width, cell.label);
            drawText(sheet, x, y + kLabel + height, width, cell.note);
            for (int line = 0; line < cell.image.height; ++line)
                std::copy_n(cell.image.pixels.begin() + ptrdiff_t(line) * cell.image.width * 3,
                            3 * cell.image.width,
                            sheet.pixels.begin() + 3 * (ptrdiff_t(y + kLabel - 6 + line) * sheet.width + x));
        }
    return sheet;
}

std::vector<std::vector<SheetCell>> inColumns(const std::vector<std::vector<SheetCell>>& stacked,
                                              size_t columns) {
    PRT_CHECK(!stacked.empty());
    PRT_CHECK_LT(size_t(0), columns);
    std::vector<std::vector<SheetCell>> rows;
    for (size_t first = 0; first < stacked[0].size(); first += columns)
        for (const std::vector<SheetCell>& cells : stacked) {
            PRT_CHECK_EQ(cells.size(), stacked[0].size());
            const size_t end = std::min(first + columns, cells.size());
            rows.emplace_back(cells.begin() + ptrdiff_t(first), cells.begin() + ptrdiff_t(end));
        }
    return rows;
}

}  // namespace prt::tools
