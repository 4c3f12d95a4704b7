#include "skinning/import/gltf_accessor.h"

#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "skinning/import/file_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <type_traits>
#include <utility>

namespace lorica {

namespace {

static_assert(std::endian::native == std::endian::little,
              "glTF is little-endian; a big-endian machine needs a byte swap here");

using Bytes = std::span<const std::byte>;

/// A type of numbers that glTF defines.
struct Component {
  int type;
  std::uint64_t bytes;
  bool isUnsigned;
};
constexpr Component kComponents[] = {
    {TINYGLTF_COMPONENT_TYPE_BYTE, 1, false},        {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, 1, true},
    {TINYGLTF_COMPONENT_TYPE_SHORT, 2, false},       {TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 2, true},
    {TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 4, true}, {TINYGLTF_COMPONENT_TYPE_FLOAT, 4, false}};

/// Without bytes for types that glTF does not define.
[[nodiscard]] Component componentOf(int type) {
  const Component* known = std::ranges::find(kComponents, type, &Component::type);
  return known == std::end(kComponents) ? Component{} : *known;
}

/// Reads `count` elements of `components` numbers, `stride` bytes apart, into rows of `out`: element i into row(i).
template <typename Stored, typename Number, typename Row>
void unpack(Bytes bytes, std::uint64_t stride, std::uint64_t count, std::size_t components, bool normalized,
            std::vector<Number>& out, const Row& row) {
  // glTF 2.0, 3.6.2.2: c / 255, c / 65535, max(c / 127, -1), max(c / 32767, -1).
  const bool scaled = normalized && std::is_integral_v<Stored>;
  const double max = std::numeric_limits<Stored>::max();
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::byte* element = bytes.data() + i * stride;
    Number* to = out.data() + row(i) * components;
    for (std::size_t c = 0; c < components; ++c) {
      Stored value;
      std::memcpy(&value, element + c * sizeof(Stored), sizeof(Stored));
      if constexpr (std::is_integral_v<Number>) {
        to[c] = static_cast<Number>(value);
      } else {
        to[c] = scaled ? std::max(value / max, -1.0) : static_cast<double>(value);
      }
    }
  }
}

template <typename Number, typename Row>
void unpackKind(int componentType, Bytes bytes, std::uint64_t stride, std::uint64_t count, std::size_t components,
                bool normalized, std::vector<Number>& out, const Row& row) {
  const auto as = [&]<typename Stored>(Stored) {
    unpack<Stored>(bytes, stride, count, components, normalized, out, row);
  };
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return as(std::uint8_t());
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return as(std::uint16_t());
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) return as(std::uint32_t());
  if constexpr (!std::is_integral_v<Number>) {
    if (componentType == TINYGLTF_COMPONENT_TYPE_BYTE) return as(std::int8_t());
    if (componentType == TINYGLTF_COMPONENT_TYPE_SHORT) return as(std::int16_t());
    if (componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return as(float());
  }
  LORICA_CHECK(false, "component types are checked before");
}

[[nodiscard]] std::string_view typeName(int components) {
  constexpr std::string_view kNames[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return components <= std::ssize(kNames) ? kNames[components - 1] : "MAT4";
}

}  // namespace

Result<void> checkIndex(const GltfDocument& document, int index, std::size_t count, const std::string& user,
                        std::string_view kind) {
  if (index >= 0 && std::cmp_less(index, count)) return {};
  if (count == 0) return badFormat("{}: {}: refers to {} {}, but the file has none", document.name, user, kind, index);
  return badFormat("{}: {}: refers to {} {}, expected 0 to {}", document.name, user, kind, index, grouped(count - 1));
}

GltfAccessors::GltfAccessors(const GltfDocument& document, std::uint64_t numbersPerByte)
    : document_(document), budget_(numbersPerByte * std::max<std::uint64_t>(document.fileBytes, 250'000)) {}

bool GltfAccessors::spend(std::uint64_t numbers) {
  if (numbers > budget_) return false;
  budget_ -= numbers;
  return true;
}

Result<Bytes> GltfAccessors::elements(int viewIndex, std::uint64_t offset, std::uint64_t count,
                                      std::uint64_t elementBytes, const std::string& who, std::uint64_t& stride) const {
  LORICA_TRY_DO(checkIndex(document_, viewIndex, document_.model.bufferViews.size(), who, "buffer view"));
  const tinygltf::BufferView& view = document_.model.bufferViews[viewIndex];
  const std::string viewName = fmt::format("buffer view {}", viewIndex);
  LORICA_TRY_DO(checkIndex(document_, view.buffer, document_.buffers.size(), viewName, "buffer"));
  const Bytes buffer = document_.buffers[view.buffer];
  if (buffer.empty()) {
    return badFormat("{}: {}: buffer {} has no data, neither embedded nor in another file", document_.name, viewName,
                     view.buffer);
  }
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    return badFormat("{}: {}: {} bytes from byte {}, but buffer {} has {}", document_.name, viewName,
                     grouped(view.byteLength), grouped(view.byteOffset), view.buffer, grouped(buffer.size()));
  }
  stride = view.byteStride == 0 ? elementBytes : view.byteStride;
  if (stride < elementBytes) {
    return badFormat("{}: {}: elements of {} bytes, but the stride of buffer view {} is {}", document_.name, who,
                     elementBytes, viewIndex, stride);
  }
  // Written with a division, so that nothing can overflow.
  const std::uint64_t bytes = view.byteLength;
  const bool fits = offset <= bytes && elementBytes <= bytes - offset &&
                    (count == 0 || count - 1 <= (bytes - offset - elementBytes) / stride);
  if (!fits) {
    const double end = offset + (count - 1) * static_cast<double>(stride) + elementBytes;
    const std::string endText =
        end < 9e15 ? "byte " + grouped(static_cast<std::uint64_t>(end)) : fmt::format("byte {:.3g}", end);
    return badFormat("{}: {}: {} elements of {} bytes end at {}, but buffer view {} has {}", document_.name, who,
                     grouped(count), elementBytes, endText, viewIndex, grouped(bytes));
  }
  return buffer.subspan(view.byteOffset + offset, (count - 1) * stride + elementBytes);
}

template <typename Number>
Result<std::vector<Number>> GltfAccessors::read(int index, int components, const std::string& user) {
  if (workStopped()) return cancelled();
  LORICA_TRY_DO(checkIndex(document_, index, document_.model.accessors.size(), user, "accessor"));
  const tinygltf::Accessor& accessor = document_.model.accessors[index];
  const std::string who = fmt::format("accessor {}", index);

  // 1. Its declaration.
  constexpr bool wantIntegers = std::is_integral_v<Number>;
  const std::size_t wanted = components;
  if (tinygltf::GetNumComponentsInType(accessor.type) != components || accessor.type == TINYGLTF_TYPE_MAT2) {
    return badFormat("{}: {}: has {} numbers per element, expected {} for {}", document_.name, who,
                     tinygltf::GetNumComponentsInType(accessor.type), typeName(components), user);
  }
  const Component component = componentOf(accessor.componentType);
  const std::uint64_t numberBytes = component.bytes;
  if (numberBytes == 0 || (wantIntegers && !component.isUnsigned)) {
    return badFormat("{}: {}: component type {}, expected {} for {}", document_.name, who, accessor.componentType,
                     wantIntegers ? "unsigned integers (5121, 5123 or 5125)" : "5120 to 5123, 5125 or 5126", user);
  }
  const std::uint64_t count = accessor.count;
  if (count == 0) return badFormat("{}: {}: has no elements, expected at least one for {}", document_.name, who, user);

  // 2. The location of its numbers, checked before any allocation.
  const std::uint64_t elementBytes = numberBytes * wanted;
  Bytes bytes;
  std::uint64_t stride = 0;
  const bool inView = accessor.bufferView != -1;
  if (inView) {
    LORICA_TRY(const Bytes found, elements(accessor.bufferView, accessor.byteOffset, count, elementBytes, who, stride));
    bytes = found;
  }
  if (count > budget_ / wanted) {
    return badFormat("{}: {}: {} elements, too many for a file of {} bytes", document_.name, who, grouped(count),
                     grouped(document_.fileBytes));
  }
  budget_ -= count * wanted;

  std::vector<Number> numbers(count * wanted, Number{});
  if (inView) {
    unpackKind(accessor.componentType, bytes, stride, count, wanted, accessor.normalized, numbers,
               [](std::uint64_t i) { return i; });
  }
  if (!accessor.sparse.isSparse) return numbers;

  // 3. Elements replaced by its sparse part.
  const auto& sparse = accessor.sparse;
  // tinygltf's offsets are signed or, from 2.9 on, unsigned; there a negative one becomes huge.
  const std::int64_t indicesFrom = sparse.indices.byteOffset;
  const std::int64_t valuesFrom = sparse.values.byteOffset;
  if (sparse.count < 1 || static_cast<std::uint64_t>(sparse.count) > count || indicesFrom < 0 || valuesFrom < 0 ||
      !componentOf(sparse.indices.componentType).isUnsigned) {
    return badFormat(
        "{}: {}: its sparse part has {} elements at bytes {} and {} with indices of type {}, expected "
        "1 to {} elements, offsets of 0 or more and unsigned indices",
        document_.name, who, sparse.count, indicesFrom, valuesFrom, sparse.indices.componentType, grouped(count));
  }
  const std::uint64_t replaced = sparse.count;
  std::uint64_t indexStride = 0;
  LORICA_TRY(const Bytes indexBytes,
             elements(sparse.indices.bufferView, indicesFrom, replaced, componentOf(sparse.indices.componentType).bytes,
                      who + ", sparse indices", indexStride));
  std::uint64_t valueStride = 0;
  LORICA_TRY(const Bytes valueBytes, elements(sparse.values.bufferView, valuesFrom, replaced, elementBytes,
                                              who + ", sparse values", valueStride));

  std::vector<std::uint32_t> rows(replaced);
  unpackKind(sparse.indices.componentType, indexBytes, indexStride, replaced, 1, false, rows,
             [](std::uint64_t i) { return i; });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] >= count) {
      return badFormat("{}: {}: sparse index {} is {}, expected 0 to {}", document_.name, who, i, rows[i],
                       grouped(count - 1));
    }
  }
  unpackKind(accessor.componentType, valueBytes, valueStride, replaced, wanted, accessor.normalized, numbers,
             [&](std::uint64_t i) { return rows[i]; });
  return numbers;
}

Result<std::vector<double>> GltfAccessors::anyNumbers(int accessor, int components, const std::string& user) {
  return read<double>(accessor, components, user);
}

Result<std::vector<std::uint32_t>> GltfAccessors::integers(int accessor, int components, const std::string& user) {
  return read<std::uint32_t>(accessor, components, user);
}

Result<GltfKeys> GltfAccessors::keys(const tinygltf::Animation& animation, int index, int components,
                                     const std::string& user) {
  LORICA_TRY_DO(checkIndex(document_, index, animation.samplers.size(), user, "sampler"));
  const tinygltf::AnimationSampler& sampler = animation.samplers[index];
  GltfKeys keys;
  if (sampler.interpolation == "STEP") {
    keys.interpolation = KeyInterpolation::kStep;
  } else if (sampler.interpolation == "CUBICSPLINE") {
    keys.interpolation = KeyInterpolation::kCubicSpline;
  } else if (sampler.interpolation != "LINEAR") {
    return badFormat("{}: {}: interpolation '{}', expected STEP, LINEAR or CUBICSPLINE", document_.name, user,
                     sampler.interpolation);
  }
  LORICA_TRY(keys.times, numbers(sampler.input, 1, user + ": times"));
  LORICA_TRY(keys.values, numbers(sampler.output, components, user + ": values"));
  return keys;
}

Result<std::vector<double>> GltfAccessors::numbers(int accessor, int components, const std::string& user) {
  LORICA_TRY(std::vector<double> all, read<double>(accessor, components, user));
  const auto broken = std::find_if(all.begin(), all.end(), [](double x) { return !std::isfinite(x); });
  if (broken != all.end()) {
    return badFormat("{}: accessor {}: element {} has {}, expected finite numbers for {}", document_.name, accessor,
                     grouped((broken - all.begin()) / components), *broken, user);
  }
  return all;
}

}  // namespace lorica
