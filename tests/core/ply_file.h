// PLY files for tests: one list of elements and values, written in each of the three formats, and packed.
// Knows nothing of the reader. Invariant: every format holds the same numbers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
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
