// PLY, text and binary of either byte order, with normals and texture coordinates per vertex or per corner.
// Format: G. Turk, "The PLY Polygon File Format", 1994.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/mesh/interrupt.h"
#include "precompute/mesh/readers.h"
#include "precompute/mesh/text_scanner.h"

namespace prt {
namespace {

enum class Number { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

struct Property {
    std::string name;
    Number type = Number::Float;
    bool isList = false;
    Number countType = Number::Uint8;
};

struct Element {
    std::string name;
    size_t count = 0;
    std::vector<Property> properties;
};

enum class Encoding { Text, Little, Big };

struct Header {
    Encoding encoding = Encoding::Text;
    std::vector<Element> elements;
    size_t end = 0;    ///< offset of the data
    size_t lines = 0;  ///< of the header
};

size_t sizeOf(Number type) {
    switch (type) {
        case Number::Int8:
        case Number::Uint8:
            return 1;
        case Number::Int16:
        case Number::Uint16:
            return 2;
        case Number::Int32:
        case Number::Uint32:
        case Number::Float:
            return 4;
        case Number::Double:
            return 8;
    }
    return 0;
}

Number numberType(std::string_view name, const TextScanner& scanner) {
    constexpr std::array<std::pair<std::string_view, Number>, 16> kTypes{{{"char", Number::Int8},
                                                                          {"uchar", Number::Uint8},
                                                                          {"short", Number::Int16},
                                                                          {"ushort", Number::Uint16},
                                                                          {"int", Number::Int32},
                                                                          {"uint", Number::Uint32},
                                                                          {"float", Number::Float},
                                                                          {"double", Number::Double},
                                                                          {"int8", Number::Int8},
                                                                          {"uint8", Number::Uint8},
                                                                          {"int16", Number::Int16},
                                                                          {"uint16", Number::Uint16},
                                                                          {"int32", Number::Int32},
                                                                          {"uint32", Number::Uint32},
                                                                          {"float32", Number::Float},
                                                                          {"float64", Number::Double}}};
    for (const auto& [word, type] : kTypes)
        if (word == name) return type;
    scanner.fail("a property has a type that PLY does not know");
}

Header readHeader(std::string_view bytes, const std::string& where) {
    Header header;
    TextScanner scanner(bytes, where);
    if (scanner.restOfLine() != "ply") scanner.fail("the file does not start with 'ply'");
    bool hasFormat = false;
    for (;;) {
        if (scanner.position() >= bytes.size()) scanner.fail("the file ends inside its header");
        std::string_view line = scanner.restOfLine();
        const std::string_view keyword = takeWord(line);
        if (keyword == "end_header") break;
        if (keyword == "format") {
            const std::string_view format = takeWord(line);
            hasFormat = true;
            if (format == "ascii")
                header.encoding = Encoding::Text;
            else if (format == "binary_little_endian")
                header.encoding = Encoding::Little;
            else if (format == "binary_big_endian")
                header.encoding = Encoding::Big;
            else
                scanner.fail("the format is none of ascii, binary_little_endian, binary_big_endian");
        } else if (keyword == "element") {
            Element element;
            element.name = std::string(takeWord(line));
            const auto count = parseInteger(takeWord(line));
            if (!count || *count < 0) scanner.fail("an element has no count");
            element.count = size_t(*count);
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty()) scanner.fail("a property stands before any element");
            Property property;
            std::string_view type = takeWord(line);
            property.isList = type == "list";
            if (property.isList) {
                property.countType = numberType(takeWord(line), scanner);
                type = takeWord(line);
            }
            property.type = numberType(type, scanner);
            property.name = std::string(takeWord(line));
            header.elements.back().properties.push_back(std::move(property));
        } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
            scanner.fail("the header has a line that PLY does not know");
        }
    }
    if (!hasFormat) scanner.fail("the header has no format line");
    header.end = scanner.position();
    header.lines = scanner.line() - 1;
    return header;
}

/// Refuses counts that the rest of the file cannot hold, before anything is allocated.
void checkCounts(const Header& header, size_t bytes, const std::string& where) {
    double needed = 0;
    for (const Element& element : header.elements) {
        double each = 0;
        for (const Property& p : element.properties)
            each += header.encoding == Encoding::Text ? 2.0 : double(sizeOf(p.isList ? p.countType : p.type));
        // An element without properties takes no room; no mesh needs one.
        if (element.properties.empty() && element.count > 0)
            throw InputError(where, fmt::format("element '{}' has no properties", element.name),
                             "re-export the mesh");
        needed += each * double(element.count);
    }
    // The last line of a text may lack its end.
    const double present = double(bytes - header.end) + 1;
    if (needed <= present) return;
    std::string counts;
    for (const Element& element : header.elements)
        counts += fmt::format("{}{} of '{}'", counts.empty() ? "" : ", ", element.count, element.name);
    throw InputError(where,
                     fmt::format("is truncated: its header promises {}, at least {:.0f} bytes, and {} follow",
                                 counts, needed, bytes - header.end),
                     "copy or export the file again");
}

/// Numbers of the body, one after the other, whatever the encoding.
class Body {
  public:
    Body(std::string_view bytes, const Header& header, std::string where)
        : encoding_(header.encoding),
          bytes_(bytes.substr(header.end)),
          where_(std::move(where)),
          lineOffset_(header.lines),
          text_(bytes_, where_) {}

    double number(Number type, const Element& element, size_t index) {
        if (encoding_ == Encoding::Text) {
            const std::string_view word = text_.word();
            if (word.empty()) truncated(element, index);
            if (const auto value = parseNumber(word)) return *value;
            throw InputError(here(),
                             fmt::format("{} {} has something that is not a number", element.name, index),
                             "re-export the mesh");
        }
        const size_t size = sizeOf(type);
        if (bytes_.size() - at_ < size) truncated(element, index);
        std::array<char, 8> raw;
        std::memcpy(raw.data(), bytes_.data() + at_, size);
        at_ += size;
        if ((encoding_ == Encoding::Big) == (std::endian::native == std::endian::little))
            std::reverse(raw.begin(), raw.begin() + std::ptrdiff_t(size));
        return decode(raw.data(), type);
    }

    /// Length of a list. @throws InputError  it cannot be in the file
    size_t listLength(const Property& property, const Element& element, size_t index) {
        const double length = number(property.countType, element, index);
        const double most =
            double(encoding_ == Encoding::Text ? bytes_.size() / 2 + 1
                                               : (bytes_.size() - at_) / sizeOf(property.type));
        if (!(length >= 0) || length != std::floor(length))
            fail(fmt::format("{} {} has a list of no valid length", element.name, index));
        if (length > most) truncated(element, index);
        return size_t(length);
    }

    std::string here() const {
        return encoding_ == Encoding::Text ? fmt::format("{}:{}", where_, lineOffset_ + text_.line())
                                           : where_;
    }
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(here(), problem, "re-export the mesh");
    }

  private:
    [[noreturn]] void truncated(const Element& element, size_t index) const {
        throw InputError(
            where_,
            fmt::format("is truncated: it ends inside {} {} of {}", element.name, index, element.count),
            "copy or export the file again");
    }

    template <class T>
    static double as(const char* raw) {
        T value;
        std::memcpy(&value, raw, sizeof value);
        return double(value);
    }
    static double decode(const char* raw, Number type) {
        switch (type) {
            case Number::Int8:
                return as<int8_t>(raw);
            case Number::Uint8:
                return as<uint8_t>(raw);
            case Number::Int16:
                return as<int16_t>(raw);
            case Number::Uint16:
                return as<uint16_t>(raw);
            case Number::Int32:
                return as<int32_t>(raw);
            case Number::Uint32:
                return as<uint32_t>(raw);
            case Number::Float:
                return as<float>(raw);
            case Number::Double:
                return as<double>(raw);
        }
        return 0;
    }

    Encoding encoding_;
    std::string_view bytes_;
    std::string where_;
    size_t lineOffset_, at_ = 0;
    TextScanner text_;
};

int findProperty(const Element& element, std::initializer_list<std::string_view> names, bool list) {
    for (size_t i = 0; i < element.properties.size(); ++i)
        for (std::string_view name : names)
            if (element.properties[i].name == name && element.properties[i].isList == list) return int(i);
    return -1;
}

class PlyReader {
  public:
    PlyReader(std::string_view bytes, const Header& header, std::string where, LoadMeshReport& report)
        : header_(header), where_(std::move(where)), body_(bytes, header, where_), polygons_(mesh_, report) {}

    CornerMesh read() {
        for (const Element& element : header_.elements) {
            if (element.name == "vertex")
                readVertices(element);
            else if (element.name == "face")
                readFaces(element);
            else
                skip(element);
        }
        return std::move(mesh_);
    }

  private:
    void readVertices(const Element& element);
    void readFaces(const Element& element);
    void skip(const Element& element) {
        std::vector<double> values;
        for (size_t i = 0; i < element.count; ++i)
            for (const Property& property : element.properties) readProperty(property, element, i, values);
    }
    void readProperty(const Property& property, const Element& element, size_t index,
                      std::vector<double>& values) {
        values.resize(property.isList ? body_.listLength(property, element, index) : 1);
        for (double& value : values) value = body_.number(property.type, element, index);
    }
    void addFace(const std::vector<double>& corners, const std::vector<double>& wedges, bool hasWedges);

    const Header& header_;
    const std::string where_;
    Body body_;
    CornerMesh mesh_;
    PolygonAppender polygons_;
    bool vertexNormals_ = false, vertexTexcoords_ = false;
    std::vector<uint32_t> corners_, texcoords_;
};

void PlyReader::readVertices(const Element& element) {
    const auto scalar = [&](std::initializer_list<std::string_view> names) {
        return findProperty(element, names, false);
    };
    const std::array<int, 8> slot{scalar({"x"}),
                                  scalar({"y"}),
                                  scalar({"z"}),
                                  scalar({"nx"}),
                                  scalar({"ny"}),
                                  scalar({"nz"}),
                                  scalar({"s", "u", "texture_u", "texture_s", "tex_u"}),
                                  scalar({"t", "v", "texture_v", "texture_t", "tex_v"})};
    if (slot[0] < 0 || slot[1] < 0 || slot[2] < 0) body_.fail("its vertices have no x, y and z");
    vertexNormals_ = slot[3] >= 0 && slot[4] >= 0 && slot[5] >= 0;
    vertexTexcoords_ = slot[6] >= 0 && slot[7] >= 0;
    mesh_.positions.reserve(element.count);
    std::vector<double> value(element.properties.size()), values;
    for (size_t i = 0; i < element.count; ++i) {
        throwIfInterruptedAt(i);
        for (size_t p = 0; p < element.properties.size(); ++p) {
            readProperty(element.properties[p], element, i, values);
            value[p] = values.empty() ? 0 : values[0];
        }
        const auto at = [&](size_t s) { return float(value[size_t(slot[s])]); };
        mesh_.positions.emplace_back(at(0), at(1), at(2));
        if (!mesh_.positions.back().allFinite())
            body_.fail(fmt::format("vertex {} has a position that is not finite", i));
        if (vertexNormals_) mesh_.normals.emplace_back(at(3), at(4), at(5));
        // Their v points up.
        if (vertexTexcoords_) mesh_.uv0.emplace_back(at(6), 1 - at(7));
    }
}

void PlyReader::readFaces(const Element& element) {
    const int list = findProperty(element, {"vertex_indices", "vertex_index"}, true);
    if (list < 0) body_.fail("its faces have no list vertex_indices");
    const int wedge = findProperty(element, {"texcoord"}, true);
    std::vector<double> corners, wedges, other;
    for (size_t i = 0; i < element.count; ++i) {
        throwIfInterruptedAt(i);
        for (int p = 0; p < int(element.properties.size()); ++p)
            readProperty(element.properties[size_t(p)], element, i,
                         p == list    ? corners
                         : p == wedge ? wedges
                                      : other);
        for (double index : corners)
            if (!(index >= 0) || index >= double(mesh_.positions.size()) || index != std::floor(index))
                body_.fail(fmt::format("face {} uses vertex {} of {}", i, index, mesh_.positions.size()));
        addFace(corners, wedges, wedge >= 0);
    }
}

void PlyReader::addFace(const std::vector<double>& corners, const std::vector<double>& wedges,
                        bool hasWedges) {
    corners_.assign(corners.begin(), corners.end());
    const std::span<const uint32_t> none, same(corners_);
    std::span<const uint32_t> texcoord = vertexTexcoords_ ? same : none;
    if (hasWedges) {
        texcoords_.clear();
        for (size_t k = 0; k < corners.size(); ++k) {
            const bool present = wedges.size() == 2 * corners.size();
            texcoords_.push_back(present ? uint32_t(mesh_.uv0.size()) : kNone);
            if (present) mesh_.uv0.emplace_back(float(wedges[2 * k]), float(1 - wedges[2 * k + 1]));
        }
        texcoord = texcoords_;
    }
    polygons_.append(corners_, vertexNormals_ ? same : none, texcoord, 0, where_);
}

}  // namespace

CornerMesh readPly(const std::filesystem::path& path, LoadMeshReport& report) {
    const std::string bytes = readFile(path);
    const Header header = readHeader(bytes, path.string());
    checkCounts(header, bytes.size(), path.string());
    return PlyReader(bytes, header, path.string(), report).read();
}

}  // namespace prt
