#include "core/gltf_accessor.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace glint {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little endian and are read as they lie");

// More elements than indices of a primitive kind can count; also keeps every product below far from 2^64.
constexpr std::size_t kMaxElements = std::size_t{1} << 29;

// The table of glTF 2.0, section 3.6.2.2. tinygltf lets 5124 and 5127-5130 pass, which glTF does not know. 0 = refused.
std::size_t component_bytes(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
        default: return 0;
    }
}

// Components of what vertices and indices are made of; 0 for matrices, which only skins use.
int components_of(int type) {
    switch (type) {
        case TINYGLTF_TYPE_SCALAR: return 1;
        case TINYGLTF_TYPE_VEC2: return 2;
        case TINYGLTF_TYPE_VEC3: return 3;
        case TINYGLTF_TYPE_VEC4: return 4;
        default: return 0;
    }
}

template <typename T>
double load(const unsigned char* p) {
    T value;
    std::memcpy(&value, p, sizeof(T));  // elements need not be aligned
    return static_cast<double>(value);
}

double load_component(const unsigned char* p, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return normalized ? std::max(load<std::int8_t>(p) / 127.0, -1.0) : load<std::int8_t>(p);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return load<std::uint8_t>(p) / (normalized ? 255.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return normalized ? std::max(load<std::int16_t>(p) / 32767.0, -1.0) : load<std::int16_t>(p);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return load<std::uint16_t>(p) / (normalized ? 65535.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return load<std::uint32_t>(p);
        default: return load<float>(p);
    }
}

// The bytes of `count` > 0 elements of `element` bytes, `stride` apart. Everything is compared by subtraction and
// division, so that no sum or product of file numbers can wrap around.
const unsigned char* checked_bytes(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
                                   std::size_t stride, std::size_t element, const std::string& place, const GltfReport& report) {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model.bufferViews.size()) {
        report.fail(place + " names no buffer view");
    }
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    const std::string view_place = "bufferViews[" + std::to_string(view_index) + "]";
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size()) {
        report.fail(view_place + " names no buffer");
    }
    const auto& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
        report.fail(view_place + " reaches past the end of its buffer");
    }
    const bool fits = offset <= view.byteLength && element <= view.byteLength - offset &&
                      count - 1 <= (view.byteLength - offset - element) / stride;
    if (!fits) report.fail(place + " reaches past the end of " + view_place);
    return bytes.data() + view.byteOffset + offset;
}

}  // namespace

AccessorView::AccessorView(const tinygltf::Model& model, int accessor_index, const GltfReport& report) {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
    const std::string place = "accessors[" + std::to_string(accessor_index) + "]";
    component_type_ = accessor.componentType;
    component_size_ = component_bytes(component_type_);
    components_ = components_of(accessor.type);
    normalized_ = accessor.normalized && component_type_ != TINYGLTF_COMPONENT_TYPE_FLOAT;
    size_ = accessor.count;
    if (component_size_ == 0)
        report.fail(place + " has componentType " + std::to_string(component_type_) + ", which glTF does not know");
    if (components_ == 0) report.fail(place + " holds matrices where numbers or vectors are needed");
    if (size_ > kMaxElements) report.fail(place + " announces " + std::to_string(size_) + " elements");
    const std::size_t element = component_size_ * static_cast<std::size_t>(components_);
    stride_ = element;
    if (accessor.bufferView >= 0 && size_ > 0) {
        const auto view = static_cast<std::size_t>(accessor.bufferView);
        if (view < model.bufferViews.size() && model.bufferViews[view].byteStride != 0)
            stride_ = model.bufferViews[view].byteStride;
        if (stride_ < element) report.fail(place + " has elements larger than the byteStride of its buffer view");
        data_ = checked_bytes(model, accessor.bufferView, accessor.byteOffset, size_, stride_, element, place, report);
    }
    if (accessor.sparse.isSparse) read_sparse(model, accessor, element, place + ".sparse", report);
}

void AccessorView::read_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t element,
                               const std::string& place, const GltfReport& report) {
    const auto& sparse = accessor.sparse;
    if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > size_)
        report.fail(place + " replaces more elements than there are");
    if (sparse.count == 0) return;
    const int type = sparse.indices.componentType;
    const bool unsigned_type = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                               type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!unsigned_type) report.fail(place + ".indices has componentType " + std::to_string(type) + ", which indices cannot have");
    if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) report.fail(place + " has a negative byteOffset");
    const auto count = static_cast<std::size_t>(sparse.count);
    const std::size_t index_size = component_bytes(type);
    const unsigned char* indices =
        checked_bytes(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count, index_size,
                      index_size, place + ".indices", report);
    sparse_values_ = checked_bytes(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count,
                                   element, element, place + ".values", report);
    sparse_indices_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto index = static_cast<std::uint32_t>(load_component(indices + i * index_size, type, false));
        if (index >= size_)
            report.fail(place + ".indices names element " + std::to_string(index) + " of " + std::to_string(size_));
        // glTF asks for this order; it makes the replacement of an element one binary search.
        if (i > 0 && index <= sparse_indices_.back()) report.fail(place + ".indices do not ascend");
        sparse_indices_.push_back(index);
    }
}

bool AccessorView::is_index() const {
    return components_ == 1 && !normalized_ &&
           (component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
            component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT || component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
}

double AccessorView::component(std::size_t i, int c) const {
    const std::size_t within = static_cast<std::size_t>(c) * component_size_;
    if (!sparse_indices_.empty()) {
        const auto found = std::lower_bound(sparse_indices_.begin(), sparse_indices_.end(), i);
        if (found != sparse_indices_.end() && *found == i) {
            const auto slot = static_cast<std::size_t>(found - sparse_indices_.begin());
            const std::size_t element = component_size_ * static_cast<std::size_t>(components_);
            return load_component(sparse_values_ + slot * element + within, component_type_, normalized_);
        }
    }
    return data_ == nullptr ? 0.0 : load_component(data_ + i * stride_ + within, component_type_, normalized_);
}

}  // namespace glint
