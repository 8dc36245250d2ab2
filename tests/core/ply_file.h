// PLY files for tests: one list of elements and values, written in each of the three formats, and packed.
// Knows nothing of the reader. Invariant: every format holds the same numbers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <libdeflate.h>
#include <unistd.h>

namespace glint::test {

struct PlyValue {
    std::string type;
    double value;
};

// One record is a list of values with their types, the length of a list being a value like others.
class PlyFile {
public:
    explicit PlyFile(std::string header) : header_(std::move(header)) {}
    void add(std::vector<PlyValue> record) { records_.push_back(std::move(record)); }

    [[nodiscard]] std::string text() const {
        std::string out = head("ascii");
        for (const auto& record : records_) {
            for (const PlyValue& v : record) {
                out += v.type == "float" ? fmt::format("{} ", static_cast<float>(v.value)) : fmt::format("{} ", v.value);
            }
            out.back() = '\n';
        }
        return out;
    }
    [[nodiscard]] std::string binary(bool big) const {
        std::string out = head(big ? "binary_big_endian" : "binary_little_endian");
        for (const auto& record : records_) {
            for (const PlyValue& v : record) out += bytes(v, big);
        }
        return out;
    }

private:
    [[nodiscard]] std::string head(const std::string& format) const { return "ply\nformat " + format + " 1.0\n" + header_; }

    template <class T>
    static std::string raw(double value, bool big) {
        const T x = static_cast<T>(value);
        std::string s(sizeof x, '\0');
        std::memcpy(s.data(), &x, sizeof x);
        if (big) std::reverse(s.begin(), s.end());
        return s;
    }
    static std::string bytes(const PlyValue& v, bool big) {
        if (v.type == "char") return raw<std::int8_t>(v.value, big);
        if (v.type == "uchar") return raw<std::uint8_t>(v.value, big);
        if (v.type == "short") return raw<std::int16_t>(v.value, big);
        if (v.type == "ushort") return raw<std::uint16_t>(v.value, big);
        if (v.type == "int") return raw<std::int32_t>(v.value, big);
        if (v.type == "uint") return raw<std::uint32_t>(v.value, big);
        return v.type == "float" ? raw<float>(v.value, big) : raw<double>(v.value, big);
    }

    std::string header_;
    std::vector<std::vector<PlyValue>> records_;
};

inline const std::string kMeshHeader =
    "comment properties in no usual order\nobj_info none\nelement material 2\nproperty list ushort double weights\n"
    "property char kind\nelement vertex 6\nproperty uchar red\nproperty double z\nproperty float nx\nproperty float x\n"
    "property list uchar short links\nproperty float ny\nproperty float y\nproperty float nz\nelement face 3\n"
    "property int flags\nproperty list uchar uint vertex_indices\nproperty list uchar float texcoord\nelement edge 1\n"
    "property int vertex1\nproperty int vertex2\nend_header\n";

// An arrow head (concave) with its notch at vertex 2, a triangle above it, and one without area.
inline PlyFile arrow() {
    PlyFile file(kMeshHeader);
    file.add({{"ushort", 2}, {"double", 0.5}, {"double", -1e300}, {"char", -7}});
    file.add({{"ushort", 0}, {"char", 1}});
    const double third = 1.0 / 3.0;
    const double points[6][3] = {{-1.1, 0, third}, {0, 3e-5, third}, {1.7, 0, third}, {0, 2.5, third}, {0, 1, 2}, {0, 1, 2}};
    for (int i = 0; i < 6; ++i) {
        const double n = i == 5 ? std::numeric_limits<double>::quiet_NaN() : 2.0 * (i % 3);
        std::vector<PlyValue> record{{"uchar", 200.0}, {"double", points[i][2]}, {"float", 0.0}, {"float", points[i][0]}};
        record.push_back({"uchar", static_cast<double>(i)});
        for (int k = 0; k < i; ++k) record.push_back({"short", -300.0 * k});
        record.push_back({"float", 0.0});
        record.push_back({"float", points[i][1]});
        record.push_back({"float", n});
        file.add(record);
    }
    file.add({{"int", -5}, {"uchar", 4}, {"uint", 0}, {"uint", 1}, {"uint", 2}, {"uint", 3}, {"uchar", 1}, {"float", 0.25}});
    file.add({{"int", 1}, {"uchar", 3}, {"uint", 2}, {"uint", 3}, {"uint", 4}, {"uchar", 0}});
    file.add({{"int", 1}, {"uchar", 3}, {"uint", 3}, {"uint", 4}, {"uint", 5}, {"uchar", 0}});
    file.add({{"int", 0}, {"int", 1}});
    return file;
}

inline const std::string kQuad =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
    "property list char int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

inline std::string gzipped(const std::string& bytes) {
    libdeflate_compressor* const compressor = libdeflate_alloc_compressor(6);
    std::string out(libdeflate_gzip_compress_bound(compressor, bytes.size()), '\0');
    out.resize(libdeflate_gzip_compress(compressor, bytes.data(), bytes.size(), out.data(), out.size()));
    libdeflate_free_compressor(compressor);
    return out;
}

// A test with a folder of its own, removed afterwards.
class MeshFileTest : public testing::Test {
protected:
    MeshFileTest() {
        static int count = 0;
        folder_ = std::filesystem::temp_directory_path() / fmt::format("glint_mesh_{}_{}", getpid(), count++);
        std::filesystem::create_directories(folder_);
    }
    ~MeshFileTest() override { std::filesystem::remove_all(folder_); }
    [[nodiscard]] std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return (folder_ / name).string();
    }

private:
    std::filesystem::path folder_;
};

}  // namespace glint::test
