// tables/ENV.KIND.LAYOUT.exr: what the run time looks up by normal.
// Sources: the layout is this project's own (tools/docs/formats.md); cube orientation math/sphere_map.h.
#include "precompute/io/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"

namespace prt {
namespace {

constexpr const char* kColours = "RGB";

/// Channel of a colour and layer; triple-product layers lie four to an RGBA layer, the mean last.
std::string channelName(TableKind kind, int layers, int colour, int layer) {
    const std::string name(1, kColours[colour]);
    if (kind == TableKind::LightCosine) return indexedName(name, layer);
    if (layer == layers - 1) return "mean." + name;
    return indexedName(name, layer / 4) + "." + "RGBA"[layer % 4];
}

int layersOf(TableKind kind, int shOrder, int components) {
    return kind == TableKind::LightCosine ? shOrder * shOrder : components + 1;
}

TableKind kindFromName(const std::string& name, const std::string& path) {
    for (TableKind kind : {TableKind::LightCosine, TableKind::TripleProduct})
        if (name == tableKindName(kind)) return kind;
    throw InputError(path, fmt::format("is a table of unknown kind \"{}\"", name));
}

}  // namespace

const char* tableKindName(TableKind kind) {
    return kind == TableKind::LightCosine ? "light-cosine" : "triple-product";
}

void writeTableFile(const std::string& path, const NormalTable& table) {
    PRT_CHECK(table.size >= TableLayout::minSize(table.layout) && table.size <= TableLayout::kMaxSize);
    PRT_CHECK(table.shOrder >= 1 && table.shOrder <= kMaxFileShOrder);
    if (table.kind == TableKind::LightCosine)
        PRT_CHECK_EQ(table.layers, table.shOrder * table.shOrder);
    else
        PRT_CHECK(table.layers >= 2 && table.layers <= table.shOrder * table.shOrder + 1);
    PRT_CHECK_EQ(table.values.size(), size_t(3) * size_t(table.layers) * table.texels());
    ExrPartOut part;
    std::tie(part.width, part.height) = std::tuple_cat(table.imageSize());
    part.attributes = conventionAttributes("normal-table", table.shOrder, table.attributes);
    part.attributes.strings["tableKind"] = tableKindName(table.kind);
    part.attributes.strings["layout"] = table.layout;
    part.attributes.ints["size"] = table.size;
    const bool triple = table.kind == TableKind::TripleProduct;
    if (triple) part.attributes.ints["componentCount"] = table.layers - 1;
    const size_t rowBytes = size_t(part.width) * sizeof(float);
    const std::vector<float> zeros(table.texels());
    for (int colour = 0; colour < 3; ++colour) {
        for (int layer = 0; layer < table.layers; ++layer)
            part.channels.push_back({channelName(table.kind, table.layers, colour, layer), ExrType::Float,
                                     table.layer(colour, layer), sizeof(float), rowBytes});
        // The last RGBA layer is filled up, so that a reader may take it whole.
        for (int layer = table.layers - 1; triple && layer % 4 != 0; ++layer)
            part.channels.push_back(
                {indexedName(std::string(1, kColours[colour]), layer / 4) + "." + "RGBA"[layer % 4],
                 ExrType::Float, zeros.data(), sizeof(float), rowBytes});
    }
    writeExr(path, {part});
}

NormalTable readTableFile(const std::string& path) {
    const ExrReader reader(path);
    const ExrPartInfo& part = reader.parts().at(0);
    NormalTable table;
    table.attributes = checkConventions(part.attributes, "normal-table", path);
    table.kind = kindFromName(requireString(part.attributes, "tableKind", path), path);
    table.layout = requireString(part.attributes, "layout", path);
    if (std::find(TableLayout::names().begin(), TableLayout::names().end(), table.layout) ==
        TableLayout::names().end())
        throw InputError(path, fmt::format("is a table of unknown layout \"{}\"", table.layout));
    table.shOrder = requireInt(part.attributes, "shOrder", 1, kMaxFileShOrder, path);
    table.size =
        requireInt(part.attributes, "size", TableLayout::minSize(table.layout), TableLayout::kMaxSize, path);
    const int components =
        table.kind == TableKind::LightCosine
            ? 0
            : requireInt(part.attributes, "componentCount", 1, table.shOrder * table.shOrder, path);
    table.layers = layersOf(table.kind, table.shOrder, components);
    const auto [width, height] = table.imageSize();
    if (part.width != width || part.height != height)
        throw InputError(path, fmt::format("has {} x {} pixels, layout {} of size {} has {} x {}", part.width,
                                           part.height, table.layout, table.size, width, height));
    std::vector<ExrChannelIn> channels;
    for (int colour = 0; colour < 3; ++colour)
        for (int layer = 0; layer < table.layers; ++layer) {
            const std::string name = channelName(table.kind, table.layers, colour, layer);
            if (!part.channels.contains(name))
                throw InputError(path, fmt::format("has no channel {}", name),
                                 "the file is damaged; make it again");
            channels.push_back({name, ExrType::Float, nullptr, sizeof(float), size_t(width) * sizeof(float)});
        }
    table.values.resize(size_t(3) * size_t(table.layers) * table.texels());
    for (size_t i = 0; i < channels.size(); ++i) channels[i].data = table.values.data() + i * table.texels();
    reader.read(0, channels);
    return table;
}

}  // namespace prt
