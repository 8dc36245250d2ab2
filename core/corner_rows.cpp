#include "core/corner_rows.h"

#include <immintrin.h>

namespace glint {

[[gnu::target("avx2")]] void read_corners_avx2(const std::vector<glm::vec3>& from,
                                               const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                               const std::uint32_t (&index)[kCornerRun], CornerRows& rows) noexcept {
    const std::array<std::uint32_t, 3>* triangle = triangles.data();
    const glm::vec3* vectors = from.data();
    // Three numbers of four: behind the last vector there may be nothing to read.
    const __m128i three = _mm_setr_epi32(-1, -1, -1, 0);
    for (std::size_t c = 0; c < 3; ++c) {
        // Row i holds the vectors of triangles i and i + 4; then a transposition in each half.
        __m256 row[4];
        for (std::size_t i = 0; i < 4; ++i) {
            const __m128 low = _mm_maskload_ps(&vectors[triangle[index[i]][c]].x, three);
            const __m128 high = _mm_maskload_ps(&vectors[triangle[index[i + 4]][c]].x, three);
            row[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
        }
        const __m256 xy01 = _mm256_unpacklo_ps(row[0], row[1]), xy23 = _mm256_unpacklo_ps(row[2], row[3]);
        const __m256 z01 = _mm256_unpackhi_ps(row[0], row[1]), z23 = _mm256_unpackhi_ps(row[2], row[3]);
        _mm256_store_ps(rows[c][0], _mm256_shuffle_ps(xy01, xy23, _MM_SHUFFLE(1, 0, 1, 0)));
        _mm256_store_ps(rows[c][1], _mm256_shuffle_ps(xy01, xy23, _MM_SHUFFLE(3, 2, 3, 2)));
        _mm256_store_ps(rows[c][2], _mm256_shuffle_ps(z01, z23, _MM_SHUFFLE(1, 0, 1, 0)));
    }
}

}  // namespace glint
