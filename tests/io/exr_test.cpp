// visibility.exr, pca.exr and tables: exact round trips, and every damage refused.
#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>

#include <bit>
#include <functional>
#include <random>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/projection_attributes.h"
#include "precompute/io/sun_shadow_file.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "tests/base/small_disk.h"
#include "tests/base/temporary_directory.h"
#include "tests/io/small_maps.h"

namespace prt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string messageOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no InputError";
}

void expectEqual(const VisibilityMap& a, const VisibilityMap& b) {
    EXPECT_EQ(a.grid.domain, b.grid.domain);
    EXPECT_EQ(a.grid.width, b.grid.width);
    EXPECT_EQ(a.grid.height, b.grid.height);
    EXPECT_EQ(a.grid.count, b.grid.count);
    EXPECT_EQ(a.shOrder, b.shOrder);
    EXPECT_EQ(a.coefficients, b.coefficients);
    EXPECT_EQ(a.validity, b.validity);
    EXPECT_EQ(a.ao, b.ao);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.attributes, b.attributes);
}

class VisibilityOrders : public testing::TestWithParam<int> {};

TEST_P(VisibilityOrders, RoundTripPerTexelIsExact) {
    TemporaryDirectory directory;
    const VisibilityMap map = randomVisibility({PointDomain::Texel, 37, 21, 37 * 21}, GetParam());
    writeVisibilityFile(directory.file("v.exr"), map);
    expectEqual(readVisibilityFile(directory.file("v.exr")), map);
    EXPECT_THAT(directory.names(), ElementsAre("v.exr"));
}
INSTANTIATE_TEST_SUITE_P(Each, VisibilityOrders, testing::Range(1, 11));

class VisibilityVertices : public testing::TestWithParam<size_t> {};

TEST_P(VisibilityVertices, RoundTripPerVertexIsExact) {
    TemporaryDirectory directory;
    const VisibilityMap map = randomVisibility(vertexGrid(GetParam()), 3);
    writeVisibilityFile(directory.file("v.exr"), map);
    expectEqual(readVisibilityFile(directory.file("v.exr")), map);
}
INSTANTIATE_TEST_SUITE_P(Each, VisibilityVertices, testing::Values(1, 7, 1023, 1024, 1025, 5000));

TEST(VertexGrid, WrapsRows) {
    EXPECT_EQ(vertexGrid(0).height, 1);
    EXPECT_EQ(vertexGrid(1).height, 1);
    EXPECT_EQ(vertexGrid(1024).height, 1);
    EXPECT_EQ(vertexGrid(1025).height, 2);
    EXPECT_EQ(vertexGrid(1025).width, 1024);
    EXPECT_EQ(vertexGrid(1025).count, 1025u);
    EXPECT_EQ(vertexGrid(1025).domain, PointDomain::Vertex);
}

TEST(Visibility, BytesDoNotDependOnThreads) {
    TemporaryDirectory directory;
    const VisibilityMap map = randomVisibility({PointDomain::Texel, 64, 200, 64 * 200}, 4);
    std::string first;
    for (int threads : {1, 2, 7}) {
        setThreadCount(threads);
        writeVisibilityFile(directory.file("v.exr"), map);
        const std::string bytes = readFile(directory.file("v.exr"));
        if (first.empty()) first = bytes;
        EXPECT_EQ(bytes, first) << threads;
    }
    setThreadCount(0);
}

TEST(Visibility, SpecialNumbersSurvive) {
    TemporaryDirectory directory;
    VisibilityMap map = randomVisibility(vertexGrid(3), 1);
    map.coefficients = {-0.0f, std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max()};
    writeVisibilityFile(directory.file("v.exr"), map);
    const VisibilityMap back = readVisibilityFile(directory.file("v.exr"));
    for (size_t i = 0; i < 3; ++i)
        EXPECT_EQ(std::bit_cast<uint32_t>(back.coefficients[i]),
                  std::bit_cast<uint32_t>(map.coefficients[i]));
}

TEST(Visibility, HeaderCarriesTheConventions) {
    TemporaryDirectory directory;
    writeVisibilityFile(directory.file("v.exr"), randomVisibility(vertexGrid(5), 2));
    const ExrReader reader(directory.file("v.exr"));
    const ExrPartInfo& part = reader.parts().at(0);
    EXPECT_EQ(part.attributes.ints.at("formatVersion"), 1);
    EXPECT_EQ(part.attributes.ints.at("shOrder"), 2);
    EXPECT_EQ(part.attributes.ints.at("vertexCount"), 5);
    EXPECT_EQ(part.attributes.strings.at("domain"), "vertex");
    EXPECT_EQ(part.attributes.strings.at("projection"), "plain");
    for (const char* name : {"shConvention", "worldAxes", "visibilityConvention"})
        EXPECT_TRUE(part.attributes.strings.contains(name)) << name;
    for (const char* name : {"V.00", "V.01", "V.02", "V.03", "ao", "normal.X", "normal.Y", "normal.Z"})
        EXPECT_EQ(part.channels.at(name), ExrType::Float) << name;
    EXPECT_EQ(part.channels.at("validity"), ExrType::Uint);
    EXPECT_EQ(part.channels.size(), 9u);
}

// Projections survive the files; attributes as they stand in the header.
TEST(Projection, RoundTripsThroughBothFiles) {
    TemporaryDirectory directory;
    for (const Projection& projection :
         {kPlainProjection, Projection{}, Projection{ProjectionKind::Irradiance, {1.0 / 3, 0}}}) {
        VisibilityMap map = randomVisibility(vertexGrid(5), 2);
        map.projection = projection;
        writeVisibilityFile(directory.file("v.exr"), map);
        const VisibilityMap back = readVisibilityFile(directory.file("v.exr"));
        EXPECT_EQ(back.projection, projection);
        EXPECT_EQ(back.attributes, map.attributes);
        PcaMap pca = randomPca(vertexGrid(5), 2, 3);
        pca.projection = projection;
        writePcaFile(directory.file("p.exr"), pca);
        EXPECT_EQ(readPcaFile(directory.file("p.exr")).projection, projection);
        EXPECT_EQ(readPcaFile(directory.file("p.exr")).attributes, pca.attributes);
    }
}

TEST(Projection, AttributesInTheHeader) {
    std::map<std::string, std::string> attributes = {{"rays", "64"}, {"projectionFloor", "of another"}};
    setProjection(kPlainProjection, attributes);
    EXPECT_EQ(attributes, (std::map<std::string, std::string>{{"rays", "64"}, {"projection", "plain"}}));
    setProjection({ProjectionKind::Irradiance, {35, 0.002}}, attributes);
    EXPECT_EQ(attributes, (std::map<std::string, std::string>{{"rays", "64"},
                                                              {"projection", "irradiance"},
                                                              {"projectionConeDegrees", "35"},
                                                              {"projectionFloor", "0.002"}}));
}

TEST(Projection, FilesWithoutOneArePlain) {
    std::map<std::string, std::string> attributes = {{"rays", "64"}};
    EXPECT_EQ(takeProjection(attributes, "v.exr"), kPlainProjection);
    EXPECT_EQ(attributes, (std::map<std::string, std::string>{{"rays", "64"}}));
}

TEST(Projection, DamagedOnesAreRefused) {
    using Attributes = std::map<std::string, std::string>;
    const auto with = [](const char* kind, const char* cone, const char* floor) {
        return Attributes{{"projection", kind}, {"projectionConeDegrees", cone}, {"projectionFloor", floor}};
    };
    for (Attributes attributes :
         {Attributes{{"projection", ""}}, Attributes{{"projection", "cosine"}},
          Attributes{{"projection", "irradiance"}},
          Attributes{{"projection", "irradiance"}, {"projectionFloor", "0.1"}},
          with("irradiance", "forty", "0.1"), with("irradiance", "40 ", "0.1"), with("irradiance", "", "0.1"),
          with("irradiance", "40", "-0.1"), with("irradiance", "40", "1e999"),
          with("irradiance", "nan", "0.1"), with("irradiance", "180", "0.1")}) {
        try {
            takeProjection(attributes, "dir/v.exr");
            ADD_FAILURE() << "accepted";
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("dir/v.exr"));
        }
    }
}

TEST(Visibility, OwnAttributesNeverHideTheFilesOwn) {
    TemporaryDirectory directory;
    VisibilityMap map = randomVisibility(vertexGrid(5), 2);
    map.attributes["shConvention"] = "another";
    map.attributes["shOrder"] = "7";
    map.attributes["domain"] = "texel";
    map.attributes["projection"] = "cosine";
    map.attributes["kept"] = "yes";
    writeVisibilityFile(directory.file("v.exr"), map);
    const VisibilityMap back = readVisibilityFile(directory.file("v.exr"));
    EXPECT_EQ(back.shOrder, 2);
    EXPECT_EQ(back.grid.domain, PointDomain::Vertex);
    EXPECT_EQ(back.projection, kPlainProjection);
    EXPECT_EQ(back.attributes.at("kept"), "yes");
    EXPECT_FALSE(back.attributes.contains("shConvention"));
}

TEST(Validity, NamesAreThoseOfTheReport) {
    std::vector<std::string> names;
    for (int i = 0; i < kValidityCount; ++i) names.push_back(validityName(Validity(i)));
    EXPECT_THAT(names, ElementsAre("empty", "valid", "gutter_filled", "inside_filled", "inside"));
    EXPECT_STREQ(pointDomainName(PointDomain::Texel), "texel");
    EXPECT_STREQ(pointDomainName(PointDomain::Vertex), "vertex");
}

class PcaSizes : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(PcaSizes, RoundTripIsExact) {
    TemporaryDirectory directory;
    const auto [shOrder, components] = GetParam();
    for (const PointGrid& grid : {PointGrid{PointDomain::Texel, 19, 33, 19 * 33}, vertexGrid(1500)}) {
        const PcaMap map = randomPca(grid, shOrder, components);
        writePcaFile(directory.file("p.exr"), map);
        const PcaMap back = readPcaFile(directory.file("p.exr"));
        EXPECT_EQ(back.grid.count, grid.count);
        EXPECT_EQ(back.grid.width, grid.width);
        EXPECT_EQ(back.grid.domain, grid.domain);
        EXPECT_EQ(back.shOrder, shOrder);
        EXPECT_EQ(back.components, components);
        EXPECT_EQ(back.mean, map.mean);
        EXPECT_EQ(back.basis, map.basis);
        EXPECT_EQ(back.weights, map.weights);
        EXPECT_EQ(back.variance, map.variance);
        EXPECT_EQ(back.attributes, map.attributes);
    }
}
INSTANTIATE_TEST_SUITE_P(Each, PcaSizes,
                         testing::Values(std::pair{1, 1}, std::pair{3, 4}, std::pair{6, 16}, std::pair{6, 36},
                                         std::pair{10, 100}));

TEST(Pca, IsOneFileOfTwoNamedParts) {
    TemporaryDirectory directory;
    writePcaFile(directory.file("p.exr"), randomPca(vertexGrid(10), 3, 5));
    Imf::MultiPartInputFile file(directory.file("p.exr").c_str());
    ASSERT_EQ(file.parts(), 2);
    EXPECT_EQ(file.header(0).name(), "weights");
    EXPECT_EQ(file.header(1).name(), "basis");
    EXPECT_EQ(file.header(0).displayWindow(), file.header(1).displayWindow());
    EXPECT_EQ(file.header(1).dataWindow().max.x, 8);
    EXPECT_EQ(file.header(1).dataWindow().max.y, 5);
    EXPECT_NE(file.header(0).channels().findChannel("w.04"), nullptr);
    EXPECT_EQ(file.header(0).channels().findChannel("w.05"), nullptr);
}

class TableKinds : public testing::TestWithParam<std::pair<TableKind, int>> {};

TEST_P(TableKinds, RoundTripIsExact) {
    TemporaryDirectory directory;
    const auto [kind, layers] = GetParam();
    for (int size : {1, 4, 17}) {
        const NormalTable table = randomTable(kind, size, 3, layers);
        writeTableFile(directory.file("t.exr"), table);
        const NormalTable back = readTableFile(directory.file("t.exr"));
        EXPECT_EQ(back.kind, kind);
        EXPECT_EQ(back.size, size);
        EXPECT_EQ(back.shOrder, 3);
        EXPECT_EQ(back.layers, layers);
        EXPECT_EQ(back.values, table.values);
        EXPECT_EQ(back.attributes, table.attributes);
    }
}
INSTANTIATE_TEST_SUITE_P(Each, TableKinds,
                         testing::Values(std::pair{TableKind::LightCosine, 9},
                                         std::pair{TableKind::TripleProduct, 2},
                                         std::pair{TableKind::TripleProduct, 5},
                                         std::pair{TableKind::TripleProduct, 6},
                                         std::pair{TableKind::TripleProduct, 10}));

TEST(Table, EveryLayoutRoundTrips) {
    TemporaryDirectory directory;
    for (const std::string& layout : TableLayout::names()) {
        NormalTable table = randomTable(TableKind::TripleProduct, 4, 3, 6);
        table.layout = layout;
        table.values = randomFloats(size_t(3) * 6 * table.texels(), 6);
        writeTableFile(directory.file("t.exr"), table);
        const NormalTable back = readTableFile(directory.file("t.exr"));
        EXPECT_EQ(back.layout, layout);
        EXPECT_EQ(back.size, 4);
        EXPECT_EQ(back.values, table.values);
    }
}

TEST(SunShadowFile, RoundTrips) {
    TemporaryDirectory directory;
    for (const PointGrid& grid : {PointGrid{PointDomain::Texel, 7, 5, 35}, vertexGrid(1500)}) {
        SunShadowMap map;
        map.grid = grid;
        map.direction = Vec3f(0.6f, 0.8f, 0);
        map.angularRadiusRad = 0.01f;
        map.irradiance = {1.5f, 1.25f, 0.5f};
        for (size_t i = 0; i < grid.count; ++i) map.shadow.push_back(float(i % 65) / 64);  // exact in half
        map.attributes = {{"environmentName", "noon"}, {"environmentHash", "12ab"}};
        writeSunShadowFile(directory.file("s.exr"), map);
        const SunShadowMap back = readSunShadowFile(directory.file("s.exr"));
        EXPECT_EQ(back.grid.count, grid.count);
        EXPECT_EQ(back.direction, map.direction);
        EXPECT_EQ(back.angularRadiusRad, map.angularRadiusRad);
        EXPECT_EQ(back.irradiance, map.irradiance);
        EXPECT_EQ(back.shadow, map.shadow);
        EXPECT_EQ(back.attributes, map.attributes);
    }
    EXPECT_EQ(sunShadowFileName("sunny day"), "tables/sunny_day.sun.exr");
    EXPECT_THAT(messageOf([&] { readTableFile(directory.file("s.exr")); }), HasSubstr("sun-shadow"));
    SunShadowMap bad;
    bad.grid = {PointDomain::Texel, 2, 2, 4};
    bad.direction = Vec3f(3, 0, 0);
    bad.shadow.assign(4, 1.0f);
    writeSunShadowFile(directory.file("bad.exr"), bad);
    EXPECT_THAT(messageOf([&] { readSunShadowFile(directory.file("bad.exr")); }), HasSubstr("sunDirection"));
}

TEST(Table, ChannelsAreFourVectorsPerLayer) {
    TemporaryDirectory directory;
    const NormalTable table = randomTable(TableKind::TripleProduct, 2, 3, 6);
    writeTableFile(directory.file("t.exr"), table);
    const ExrReader reader(directory.file("t.exr"));
    std::vector<std::string> names;
    for (const auto& [name, type] : reader.parts().at(0).channels)
        if (name[0] == 'G' || name.starts_with("mean")) names.push_back(name);
    EXPECT_THAT(names, ElementsAre("G.00.A", "G.00.B", "G.00.G", "G.00.R", "G.01.A", "G.01.B", "G.01.G",
                                   "G.01.R", "mean.B", "mean.G", "mean.R"));
    EXPECT_EQ(reader.parts()[0].width, 2);
    EXPECT_EQ(reader.parts()[0].height, 12);
    std::vector<float> fourth(24), fifth(24), sixth(24), mean(24);
    reader.read(0, {{"G.00.A", ExrType::Float, fourth.data(), 4, 8},
                    {"G.01.R", ExrType::Float, fifth.data(), 4, 8},
                    {"G.01.G", ExrType::Float, sixth.data(), 4, 8},
                    {"mean.G", ExrType::Float, mean.data(), 4, 8}});
    EXPECT_EQ(fourth, std::vector<float>(table.layer(1, 3), table.layer(1, 4)));
    EXPECT_EQ(fifth, std::vector<float>(table.layer(1, 4), table.layer(1, 5)));
    EXPECT_EQ(sixth, std::vector<float>(24, 0.0f));
    EXPECT_EQ(mean, std::vector<float>(table.layer(1, 5), table.layer(1, 5) + 24));
}

// ---- damage

TEST(ExrDamage, MissingFilesAndDirectories) {
    TemporaryDirectory directory;
    EXPECT_THAT(messageOf([&] { readVisibilityFile(directory.file("absent.exr")); }),
                testing::AllOf(HasSubstr("absent.exr"), HasSubstr("No such file")));
    EXPECT_THAT(messageOf([&] { readPcaFile(directory.path()); }), HasSubstr("is a directory"));
    writeFileAtomically(directory.path() / "text.exr", "hello, this is no image");
    EXPECT_THAT(messageOf([&] { readTableFile(directory.file("text.exr")); }),
                HasSubstr("not an OpenEXR file"));
    writeFileAtomically(directory.path() / "empty.exr", "");
    EXPECT_THAT(messageOf([&] { readTableFile(directory.file("empty.exr")); }),
                HasSubstr("not an OpenEXR file"));
}

TEST(ExrDamage, OneKindIsNotAnother) {
    TemporaryDirectory directory;
    writeVisibilityFile(directory.file("v.exr"), randomVisibility(vertexGrid(5), 2));
    writePcaFile(directory.file("p.exr"), randomPca(vertexGrid(5), 2, 2));
    writeTableFile(directory.file("t.exr"), randomTable(TableKind::LightCosine, 2, 2, 4));
    EXPECT_THAT(messageOf([&] { readTableFile(directory.file("v.exr")); }),
                HasSubstr("visibility, not normal-table"));
    EXPECT_THAT(messageOf([&] { readVisibilityFile(directory.file("p.exr")); }),
                HasSubstr("pca, not visibility"));
    EXPECT_THAT(messageOf([&] { readPcaFile(directory.file("t.exr")); }), HasSubstr("weights"));
}

/// Replaces bytes of a file; attribute values of equal length keep it well-formed.
void patch(const std::string& path, const std::string& from, const std::string& to) {
    std::string bytes = readFile(path);
    const size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    bytes.replace(at, from.size(), to);
    ASSERT_EQ(from.size(), to.size());
    writeFileAtomically(path, bytes);
}

std::string intAttribute(const std::string& name, char value) {
    return name + std::string("\0int\0\4\0\0\0", 9) + value + std::string(3, '\0');
}

TEST(ExrDamage, OtherConventionsAreRefusedByName) {
    TemporaryDirectory directory;
    const std::string path = directory.file("v.exr");
    const auto write = [&] { writeVisibilityFile(path, randomVisibility(vertexGrid(5), 2)); };
    write();
    patch(path, intAttribute("formatVersion", 1), intAttribute("formatVersion", 9));
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }),
                testing::AllOf(HasSubstr("format version 9"), HasSubstr("reads 1")));
    write();
    patch(path, "+Y up", "+Z up");
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }), HasSubstr("worldAxes"));
    write();
    patch(path, "Condon", "London");
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }), HasSubstr("shConvention"));
    write();
    patch(path, intAttribute("shOrder", 2), intAttribute("shOrder", 11));
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }), HasSubstr("shOrder = 11"));
    write();
    patch(path, intAttribute("shOrder", 2), intAttribute("shOrder", 3));
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }), HasSubstr("no channel V.04"));
    write();
    patch(path, intAttribute("vertexCount", 5), intAttribute("vertexCoumt", 5));
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }), HasSubstr("no attribute vertexCount"));
    write();
    patch(path, "V.02", "V.99");
    EXPECT_THAT(messageOf([&] { readVisibilityFile(path); }), HasSubstr("no channel V.02"));
}

TEST(ExrDamage, UnknownValidityIsRefused) {
    TemporaryDirectory directory;
    VisibilityMap map = randomVisibility(vertexGrid(5), 1);
    map.validity[3] = Validity(17);
    writeVisibilityFile(directory.file("v.exr"), map);
    EXPECT_THAT(messageOf([&] { readVisibilityFile(directory.file("v.exr")); }), HasSubstr("point 3"));
}

TEST(ExrDamage, AbsurdSizesAreRefusedBeforeAllocating) {
    TemporaryDirectory directory;
    const std::string path = directory.file("v.exr");
    writeVisibilityFile(path, randomVisibility({PointDomain::Texel, 8, 8, 64}, 10));
    const size_t before = peakResidentBytes();
    const std::string window("dataWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0", 29);
    const std::string good = readFile(path);
    const size_t at = good.find(window);
    ASSERT_NE(at, std::string::npos);
    // max.x and max.y: 2³¹ − 1, 10⁵, and the largest size the reader takes, which so few bytes cannot hold.
    for (const auto& [x, y] : {std::pair<uint32_t, uint32_t>{0x7fffffff, 7},
                               {7, 0x7fffffff},
                               {0x7fffffff, 0x7fffffff},
                               {100000, 100000},
                               {131071, 131071},
                               {0xffffff00, 7}}) {
        std::string bytes = good;
        for (size_t i = 0; i < 4; ++i) {
            bytes[at + 29 + i] = char(x >> (8 * i));
            bytes[at + 33 + i] = char(y >> (8 * i));
        }
        writeFileAtomically(path, bytes);
        EXPECT_THROW(readVisibilityFile(path), InputError) << x << " x " << y;
    }
    EXPECT_LT(peakResidentBytes(), before + (size_t(256) << 20));
}

template <class Read>
void expectEveryTruncationIsRefused(const std::string& path, const Read& read) {
    const std::string whole = readFile(path);
    ASSERT_NO_THROW(read(path));
    for (size_t length = 0; length < whole.size();
         length += length < 400 || length + 100 > whole.size() ? 1 : 17) {
        rewriteFile(path, whole.substr(0, length));
        EXPECT_THROW(read(path), InputError) << length << " of " << whole.size();
    }
}

/// No damage may crash: each gives an InputError or a file that is still well-formed.
template <class Read>
void flipBytes(const std::string& path, int rounds, const Read& read) {
    const std::string whole = readFile(path);
    std::mt19937 random(7);
    int refused = 0;
    for (int i = 0; i < rounds; ++i) {
        std::string bytes = whole;
        // Every byte of the first kilobyte, where the header is; then anywhere.
        const size_t at =
            size_t(i) < std::min<size_t>(1024, whole.size()) ? size_t(i) : random() % whole.size();
        bytes[at] = char(bytes[at] ^ char(1u << random() % 8));
        rewriteFile(path, bytes);
        try {
            read(path);
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0);
}

TEST(ExrDamage, EveryTruncationIsRefused) {
    TemporaryDirectory directory;
    writeVisibilityFile(directory.file("v.exr"), randomVisibility({PointDomain::Texel, 8, 40, 320}, 2));
    expectEveryTruncationIsRefused(directory.file("v.exr"), readVisibilityFile);
    writePcaFile(directory.file("p.exr"), randomPca({PointDomain::Texel, 8, 40, 320}, 2, 3));
    expectEveryTruncationIsRefused(directory.file("p.exr"), readPcaFile);
    writeTableFile(directory.file("t.exr"), randomTable(TableKind::TripleProduct, 4, 2, 4));
    expectEveryTruncationIsRefused(directory.file("t.exr"), readTableFile);
}

TEST(ExrDamage, FlippedBitsNeverCrash) {
    TemporaryDirectory directory;
    writeVisibilityFile(directory.file("v.exr"), randomVisibility({PointDomain::Texel, 8, 40, 320}, 2));
    flipBytes(directory.file("v.exr"), 1300, readVisibilityFile);
    writePcaFile(directory.file("p.exr"), randomPca({PointDomain::Texel, 8, 40, 320}, 2, 3));
    flipBytes(directory.file("p.exr"), 1300, readPcaFile);
    writeTableFile(directory.file("t.exr"), randomTable(TableKind::TripleProduct, 4, 2, 4));
    flipBytes(directory.file("t.exr"), 1300, readTableFile);
}

TEST(ExrWrite, FullDiskLeavesTheOldFileAtEverySize) {
    TemporaryDirectory directory;
    const std::string path = directory.file("v.exr");
    const VisibilityMap map = randomVisibility({PointDomain::Texel, 16, 16, 256}, 2);
    writeVisibilityFile(path, map);
    const std::string whole = readFile(path);
    writeFileAtomically(path, "old");
    for (size_t bytes = 0; bytes < whole.size(); bytes += 97 + whole.size() / 40) {
        const SmallDisk disk(bytes);
        EXPECT_THROW(writeVisibilityFile(path, map), OutputError) << bytes;
    }
    {
        // The last byte missing: OpenEXR would notice only in a destructor.
        const SmallDisk disk(whole.size() - 1);
        EXPECT_THROW(writeVisibilityFile(path, map), OutputError);
    }
    EXPECT_EQ(readFile(path), "old");
    EXPECT_THAT(directory.names(), ElementsAre("v.exr"));
    {
        const SmallDisk disk(whole.size());
        EXPECT_NO_THROW(writeVisibilityFile(path, map));
    }
    EXPECT_EQ(readFile(path), whole);
}

TEST(ExrWrite, InterruptsLeaveTheOldFile) {
    TemporaryDirectory directory;
    const std::string path = directory.file("v.exr");
    writeFileAtomically(path, "old");
    requestInterrupt();
    EXPECT_THROW(writeVisibilityFile(path, randomVisibility({PointDomain::Texel, 16, 16, 256}, 2)),
                 Interrupted);
    clearInterrupt();
    EXPECT_EQ(readFile(path), "old");
    EXPECT_THAT(directory.names(), ElementsAre("v.exr"));
}

TEST(ExrWrite, AbsentDirectoryIsAnOutputError) {
    TemporaryDirectory directory;
    EXPECT_THROW(writeVisibilityFile(directory.file("none/v.exr"), randomVisibility(vertexGrid(5), 2)),
                 OutputError);
}

}  // namespace
}  // namespace prt
