// visibility.exr and pca.exr.
// Sources: OpenEXR 3.1 multi-part files; the layout is this project's own (tools/docs/formats.md).
#include "precompute/io/visibility_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/point_channels.h"
#include "precompute/io/projection_attributes.h"

namespace prt {
namespace {

static_assert(sizeof(Validity) == sizeof(uint32_t));

const std::vector<std::string> kNormalNames{"normal.X", "normal.Y", "normal.Z"};

void checkValidity(const std::vector<Validity>& validity, size_t first, const std::string& path) {
    for (size_t i = 0; i < validity.size(); ++i)
        if (uint32_t(validity[i]) >= uint32_t(kValidityCount))
            throw InputError(
                path, fmt::format("point {} has the unknown validity {}", first + i, uint32_t(validity[i])));
}

size_t findPart(const ExrReader& reader, const std::string& name, const std::string& path) {
    for (size_t i = 0; i < reader.parts().size(); ++i)
        if (reader.parts()[i].name == name) return i;
    throw InputError(path, fmt::format("has no part \"{}\"", name), "the file is damaged; make it again");
}

std::map<std::string, std::string> withProjection(std::map<std::string, std::string> attributes,
                                                  const Projection& projection) {
    setProjection(projection, attributes);
    return attributes;
}

}  // namespace

const char* pointDomainName(PointDomain domain) { return domain == PointDomain::Texel ? "texel" : "vertex"; }

const char* validityName(Validity validity) {
    switch (validity) {
        case Validity::Empty:
            return "empty";
        case Validity::Valid:
            return "valid";
        case Validity::GutterFilled:
            return "gutter_filled";
        case Validity::InsideFilled:
            return "inside_filled";
        case Validity::Inside:
            return "inside";
    }
    return "unknown";
}

PointGrid vertexGrid(size_t vertexCount) {
    const size_t rows = (vertexCount + size_t(kVertexRowLength) - 1) / size_t(kVertexRowLength);
    return {PointDomain::Vertex, kVertexRowLength, int(std::max<size_t>(rows, 1)), vertexCount};
}

void writeVisibilityFile(const std::string& path, const VisibilityMap& map) {
    checkGrid(map.grid);
    PRT_CHECK(map.shOrder >= 1 && map.shOrder <= kMaxFileShOrder);
    const int coefficients = map.shOrder * map.shOrder;
    const PaddedPoints values(map.coefficients, map.grid, size_t(coefficients));
    const PaddedPoints ao(map.ao, map.grid, 1);
    const PaddedPoints error(map.error.empty() ? map.ao : map.error, map.grid, 1);
    const PaddedPoints validity(map.validity, map.grid, 1);
    PRT_CHECK_EQ(map.normals.size(), map.grid.count);
    std::vector<Vec3f> normals(map.normals);
    normals.resize(gridPixels(map.grid), Vec3f::Zero());

    ExrPartOut part;
    part.width = map.grid.width;
    part.height = map.grid.height;
    part.attributes =
        conventionAttributes("visibility", map.shOrder, withProjection(map.attributes, map.projection));
    setDomain(map.grid, part.attributes);
    addInterleaved(part.channels, indexedNames("V", coefficients), ExrType::Float, values.data(), part.width,
                   size_t(coefficients));
    addInterleaved(part.channels, {"ao"}, ExrType::Float, ao.data(), part.width, 1);
    if (!map.error.empty())
        addInterleaved(part.channels, {"error"}, ExrType::Float, error.data(), part.width, 1);
    addInterleaved(part.channels, kNormalNames, ExrType::Float, normals[0].data(), part.width, 3);
    addInterleaved(part.channels, {"validity"}, ExrType::Uint, validity.data(), part.width, 1);
    writeExr(path, {part});
}

struct VisibilityReader::File {
    ExrReader exr;
    explicit File(const std::string& path) : exr(path) {}
};

VisibilityReader::VisibilityReader(const std::string& path)
    : path_(path), file_(std::make_unique<File>(path)) {
    const ExrPartInfo& part = file_->exr.parts().at(0);
    header_.attributes = checkConventions(part.attributes, "visibility", path);
    header_.projection = takeProjection(header_.attributes, path);
    header_.shOrder = requireInt(part.attributes, "shOrder", 1, kMaxFileShOrder, path);
    header_.grid = readGrid(part, path);
    checkChannels(part, indexedNames("V", header_.shOrder * header_.shOrder), path);
    checkChannels(part, {"ao", "normal.X", "normal.Y", "normal.Z", "validity"}, path);
    if (part.channels.at("validity") != ExrType::Uint)
        throw InputError(path, "the channel validity is not of unsigned integers");
}

VisibilityReader::~VisibilityReader() = default;

namespace {

/// What of a read block lies behind the last point is cut off.
void keepPoints(size_t points, size_t coefficients, std::vector<float>& rows, std::vector<Vec3f>& normals,
                std::vector<Validity>& validity) {
    rows.resize(points * coefficients);
    normals.resize(points);
    validity.resize(points);
}

/// Sizes the vectors to whole rows of pixels, and names them as channels to be read into.
std::vector<ExrChannelIn> channelsOf(const VisibilityMap& header, size_t pixels, std::vector<float>& rows,
                                     std::vector<Vec3f>& normals, std::vector<Validity>& validity) {
    const int coefficients = header.shOrder * header.shOrder, width = header.grid.width;
    rows.resize(pixels * size_t(coefficients));
    normals.resize(pixels, Vec3f::Zero());
    validity.resize(pixels);
    std::vector<ExrChannelIn> channels;
    addInterleaved(channels, indexedNames("V", coefficients), ExrType::Float, rows.data(), width,
                   size_t(coefficients));
    addInterleaved(channels, kNormalNames, ExrType::Float, normals[0].data(), width, 3);
    addInterleaved(channels, {"validity"}, ExrType::Uint, validity.data(), width, 1);
    return channels;
}

}  // namespace

void VisibilityReader::read(int firstRow, int rows, VisibilityRowBlock& block) const {
    const PointGrid& grid = header_.grid;
    const size_t width = size_t(grid.width), pixels = size_t(rows) * width;
    file_->exr.readRows(0, firstRow, rows,
                        channelsOf(header_, pixels, block.coefficients, block.normals, block.validity));
    block.first = size_t(firstRow) * width;
    keepPoints(std::min(pixels, grid.count - std::min(grid.count, block.first)),
               size_t(header_.shOrder * header_.shOrder), block.coefficients, block.normals, block.validity);
    checkValidity(block.validity, block.first, path_);
}

VisibilityMap readVisibilityFile(const std::string& path) {
    const VisibilityReader reader(path);
    const ExrReader& exr = reader.file_->exr;
    VisibilityMap map = reader.header_;
    const size_t pixels = gridPixels(map.grid), count = map.grid.count;
    std::vector<ExrChannelIn> channels =
        channelsOf(reader.header_, pixels, map.coefficients, map.normals, map.validity);
    map.ao.resize(pixels);
    addInterleaved(channels, {"ao"}, ExrType::Float, map.ao.data(), map.grid.width, 1);
    if (exr.parts()[0].channels.contains("error")) {
        map.error.resize(pixels);
        addInterleaved(channels, {"error"}, ExrType::Float, map.error.data(), map.grid.width, 1);
    }
    exr.read(0, channels);
    keepPoints(count, size_t(map.shOrder * map.shOrder), map.coefficients, map.normals, map.validity);
    map.ao.resize(count);
    if (!map.error.empty()) map.error.resize(count);
    checkValidity(map.validity, 0, path);
    return map;
}

struct PcaWriter::State {
    PointGrid grid;
    size_t components;
    std::vector<float> basis;  // the mean and the vectors below each other
    std::vector<ExrChannelOut> basisChannels;
    std::unique_ptr<ExrWriter> exr;
    size_t points = 0;  // written

    void writeRows(int rows, const float* weights) {
        std::vector<ExrChannelOut> channels;
        addInterleaved(channels, indexedNames("w", int(components)), ExrType::Float, weights, grid.width,
                       components);
        exr->writeRows(0, rows, channels);
    }
};

PcaWriter::PcaWriter(const std::string& path, const PcaMap& map) : state_(std::make_unique<State>()) {
    checkGrid(map.grid);
    PRT_CHECK(map.shOrder >= 1 && map.shOrder <= kMaxFileShOrder);
    const size_t coefficients = size_t(map.shOrder) * size_t(map.shOrder);
    PRT_CHECK(map.components >= 1 && size_t(map.components) <= coefficients);
    PRT_CHECK_EQ(map.mean.size(), coefficients);
    PRT_CHECK_EQ(map.basis.size(), coefficients * size_t(map.components));
    PRT_CHECK_EQ(map.variance.size(), size_t(map.components));
    state_->grid = map.grid;
    state_->components = size_t(map.components);
    state_->basis = map.mean;
    state_->basis.insert(state_->basis.end(), map.basis.begin(), map.basis.end());

    std::vector<ExrPartOut> parts(2);
    ExrPartOut& weightPart = parts[0];
    weightPart.name = "weights";
    weightPart.width = map.grid.width;
    weightPart.height = map.grid.height;
    weightPart.attributes =
        conventionAttributes("pca", map.shOrder, withProjection(map.attributes, map.projection));
    weightPart.attributes.ints["componentCount"] = map.components;
    weightPart.attributes.floatVectors["variance"] = map.variance;
    setDomain(map.grid, weightPart.attributes);
    for (const std::string& name : indexedNames("w", map.components))
        weightPart.channels.push_back({name, ExrType::Float, nullptr, 4, 0});
    ExrPartOut& basisPart = parts[1];
    basisPart.name = "basis";
    basisPart.width = int(coefficients);
    basisPart.height = map.components + 1;
    basisPart.attributes = conventionAttributes("pca", map.shOrder, {});
    basisPart.attributes.strings["rows"] = "row 0 the mean, row m + 1 principal vector m; columns shIndex";
    addInterleaved(basisPart.channels, {"value"}, ExrType::Float, state_->basis.data(), basisPart.width, 1);
    state_->basisChannels = basisPart.channels;
    state_->exr = std::make_unique<ExrWriter>(path, parts);
}

PcaWriter::~PcaWriter() = default;

void PcaWriter::write(std::span<const float> weights) {
    const size_t width = size_t(state_->grid.width), points = weights.size() / state_->components;
    PRT_CHECK_EQ(points * state_->components, weights.size());
    PRT_CHECK_EQ(state_->points % width, size_t(0));
    PRT_CHECK_LE(state_->points + points, state_->grid.count);
    const int rows = int((points + width - 1) / width);
    std::vector<float> padded;
    const float* data = weights.data();
    if (points % width != 0) {
        padded.assign(weights.begin(), weights.end());
        padded.resize(size_t(rows) * width * state_->components);
        data = padded.data();
    }
    if (rows > 0) state_->writeRows(rows, data);
    state_->points += points;
}

void PcaWriter::commit() {
    PRT_CHECK_EQ(state_->points, state_->grid.count);
    if (state_->grid.count == 0) {  // the grid has one row even so
        const std::vector<float> zeros(gridPixels(state_->grid) * state_->components);
        state_->writeRows(state_->grid.height, zeros.data());
    }
    state_->exr->writeRows(1, int(state_->components) + 1, state_->basisChannels);
    state_->exr->commit();
}

void writePcaFile(const std::string& path, const PcaMap& map) {
    PRT_CHECK_EQ(map.weights.size(), map.grid.count * size_t(map.components));
    PcaWriter writer(path, map);
    writer.write(map.weights);
    writer.commit();
}

PcaMap readPcaFile(const std::string& path) {
    const ExrReader reader(path);
    const size_t weightPart = findPart(reader, "weights", path), basisPart = findPart(reader, "basis", path);
    const ExrPartInfo& part = reader.parts()[weightPart];
    const ExrPartInfo& basis = reader.parts()[basisPart];
    PcaMap map;
    map.attributes = checkConventions(part.attributes, "pca", path);
    map.projection = takeProjection(map.attributes, path);
    map.shOrder = requireInt(part.attributes, "shOrder", 1, kMaxFileShOrder, path);
    const int coefficients = map.shOrder * map.shOrder;
    map.components = requireInt(part.attributes, "componentCount", 1, coefficients, path);
    map.grid = readGrid(part, path);
    if (basis.width != coefficients || basis.height != map.components + 1)
        throw InputError(path, fmt::format("has a basis of {} x {} values, expected {} x {}", basis.width,
                                           basis.height, coefficients, map.components + 1));
    const std::vector<std::string> names = indexedNames("w", map.components);
    checkChannels(part, names, path);
    checkChannels(basis, {"value"}, path);
    const auto variance = part.attributes.floatVectors.find("variance");
    if (variance == part.attributes.floatVectors.end() || variance->second.size() != size_t(map.components))
        throw InputError(path, fmt::format("has no attribute variance of {} values", map.components));
    map.variance = variance->second;

    std::vector<float> rows(size_t(coefficients) * size_t(map.components + 1));
    std::vector<ExrChannelIn> channels;
    addInterleaved(channels, {"value"}, ExrType::Float, rows.data(), basis.width, 1);
    reader.read(basisPart, channels);
    map.mean.assign(rows.begin(), rows.begin() + coefficients);
    map.basis.assign(rows.begin() + coefficients, rows.end());
    map.weights.resize(gridPixels(map.grid) * size_t(map.components));
    channels.clear();
    addInterleaved(channels, names, ExrType::Float, map.weights.data(), part.width, size_t(map.components));
    reader.read(weightPart, channels);
    map.weights.resize(map.grid.count * size_t(map.components));
    return map;
}

}  // namespace prt
