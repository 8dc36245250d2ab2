#include <xmmintrin.h>

#include <cstring>

#include "competitor.h"
#include "embree_scene.h"

namespace glint::bench {
namespace {

// Flush to zero and denormals are zero, as Embree's manual recommends (section "Performance Recommendations").
constexpr unsigned kFlushDenormals = 0x8040;

class Embree : public Competitor {
public:
    Embree(std::string name, Role role, std::shared_ptr<const EmbreeScene> scene)
        : Competitor(std::move(name), role), scene_(std::move(scene)) {}
    void begin_thread() const override { _mm_setcsr(_mm_getcsr() | kFlushDenormals); }
    void end_thread() const override { _mm_setcsr(_mm_getcsr() & ~kFlushDenormals); }

protected:
    [[nodiscard]] RTCScene scene() const { return scene_->handle(); }
    static RTCIntersectContext context(RayOrder order) {
        RTCIntersectContext c;
        rtcInitIntersectContext(&c);
        c.flags = order == RayOrder::divergent ? RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT : RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        return c;
    }

private:
    std::shared_ptr<const EmbreeScene> scene_;
};

// Without a branch: a miss leaves both ids all ones, and so gives kNoPrimitive.
PrimitiveId to_id(unsigned geometry, unsigned primitive) { return geometry << 29 | primitive; }

void set(RTCRay& to, const Ray& ray) {
    to.org_x = ray.origin.x, to.org_y = ray.origin.y, to.org_z = ray.origin.z;
    to.dir_x = ray.direction.x, to.dir_y = ray.direction.y, to.dir_z = ray.direction.z;
    to.tnear = to.time = 0.0f;
    to.tfar = ray.t_max;
    to.mask = ~0u;
    to.id = to.flags = 0;
}

void set(RTCRayHit& to, const Ray& ray) {
    set(to.ray, ray);
    to.hit.geomID = to.hit.primID = to.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

Hit hit_of(const RTCRayHit& query) {
    return {query.ray.tfar, query.hit.u, query.hit.v, to_id(query.hit.geomID, query.hit.primID)};
}

class EmbreeSingle : public Embree {
public:
    using Embree::Embree;
    void closest(RayOrder order, std::span<Block> blocks) const override {
        RTCIntersectContext c = context(order);
        for (const Block& block : blocks) {
            for (std::size_t i = 0; i < block.rays.size(); ++i) {
                RTCRayHit query;
                set(query, block.rays[i]);
                rtcIntersect1(scene(), &c, &query);
                block.hits.set(static_cast<int>(i), hit_of(query));
            }
        }
    }
    void occluded(RayOrder order, std::span<Block> blocks) const override {
        RTCIntersectContext c = context(order);
        for (const Block& block : blocks) {
            for (std::size_t i = 0; i < block.rays.size(); ++i) {
                RTCRay query;
                set(query, block.rays[i]);
                rtcOccluded1(scene(), &c, &query);
                block.occluded[i] = query.tfar < 0.0f;
            }
        }
    }
};

constexpr std::size_t kLanes = 16;

// Sixteen lanes with what never changes set once; Embree writes tfar and the hit only.
struct alignas(64) Packet {
    RTCRayHit16 query{};
    int valid[kLanes]{};

    Packet() {
        std::fill(std::begin(query.ray.mask), std::end(query.ray.mask), ~0u);
        std::fill(std::begin(query.hit.instID[0]), std::end(query.hit.instID[0]), RTC_INVALID_GEOMETRY_ID);
        std::fill(std::begin(valid), std::end(valid), -1);
    }
    void fill(const RayBatch& rays, std::size_t at, std::size_t count) {
        RTCRay16& r = query.ray;
        const auto copy = [at](float* to, const float* from) { std::memcpy(to, from + at, kLanes * sizeof(float)); };
        copy(r.org_x, rays.origin[0]), copy(r.org_y, rays.origin[1]), copy(r.org_z, rays.origin[2]);
        copy(r.dir_x, rays.direction[0]), copy(r.dir_y, rays.direction[1]), copy(r.dir_z, rays.direction[2]);
        copy(r.tfar, rays.t_max);
        if (count < kLanes) {
            for (std::size_t i = 0; i < kLanes; ++i) valid[i] = i < count ? -1 : 0;
        }
    }
    void clear_hits() {
        for (std::size_t i = 0; i < kLanes; ++i) query.hit.geomID[i] = query.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
    }
};

class EmbreePackets : public Embree {
public:
    using Embree::Embree;
    void closest(RayOrder order, std::span<Block> blocks) const override {
        RTCIntersectContext c = context(order);
        Packet packet;
        for (const Block& block : blocks) {
            for (std::size_t at = 0; at < block.rays.size(); at += kLanes) {
                const std::size_t count = std::min(kLanes, block.rays.size() - at);
                packet.fill(block.batch, at, count);
                packet.clear_hits();
                rtcIntersect16(packet.valid, scene(), &c, &packet.query);
                const RTCHit16& hit = packet.query.hit;
                for (std::size_t i = 0; i < count; ++i) {
                    block.hits.t[at + i] = packet.query.ray.tfar[i];
                    block.hits.u[at + i] = hit.u[i];
                    block.hits.v[at + i] = hit.v[i];
                    block.hits.primitive[at + i] = to_id(hit.geomID[i], hit.primID[i]);
                }
            }
        }
    }
    void occluded(RayOrder order, std::span<Block> blocks) const override {
        RTCIntersectContext c = context(order);
        Packet packet;
        for (const Block& block : blocks) {
            for (std::size_t at = 0; at < block.rays.size(); at += kLanes) {
                const std::size_t count = std::min(kLanes, block.rays.size() - at);
                packet.fill(block.batch, at, count);
                rtcOccluded16(packet.valid, scene(), &c, &packet.query.ray);
                for (std::size_t i = 0; i < count; ++i) block.occluded[at + i] = packet.query.ray.tfar[i] < 0.0f;
            }
        }
    }
};

class EmbreeStreams : public Embree {
public:
    using Embree::Embree;
    void closest(RayOrder order, std::span<Block> blocks) const override {
        RTCIntersectContext c = context(order);
        std::array<RTCRayHit, kRayBatch> queries;
        for (const Block& block : blocks) {
            const std::size_t count = block.rays.size();
            for (std::size_t i = 0; i < count; ++i) set(queries[i], block.rays[i]);
            rtcIntersect1M(scene(), &c, queries.data(), static_cast<unsigned>(count), sizeof(RTCRayHit));
            for (std::size_t i = 0; i < count; ++i) block.hits.set(static_cast<int>(i), hit_of(queries[i]));
        }
    }
    void occluded(RayOrder order, std::span<Block> blocks) const override {
        RTCIntersectContext c = context(order);
        std::array<RTCRay, kRayBatch> queries;
        for (const Block& block : blocks) {
            const std::size_t count = block.rays.size();
            for (std::size_t i = 0; i < count; ++i) set(queries[i], block.rays[i]);
            rtcOccluded1M(scene(), &c, queries.data(), static_cast<unsigned>(count), sizeof(RTCRay));
            for (std::size_t i = 0; i < count; ++i) block.occluded[i] = queries[i].tfar < 0.0f;
        }
    }
};

}  // namespace

Competitors embree_competitors(const Geometry& geometry) {
    const auto input = std::make_shared<const EmbreeInput>(geometry);
    const auto built = [&](RTCBuildQuality quality, bool robust, bool avx512) {
        return std::make_shared<const EmbreeScene>(input, EmbreeBuild{quality, robust, avx512, 2});
    };
    using Role = Competitor::Role;
    constexpr RTCBuildQuality kMedium = RTC_BUILD_QUALITY_MEDIUM, kHigh = RTC_BUILD_QUALITY_HIGH;
    const auto wide = built(kHigh, false, true), robust = built(kHigh, true, false);
    Competitors list;
    list.push_back(std::make_unique<EmbreeSingle>("embree 1, medium", Role::embree_single, built(kMedium, false, false)));
    list.push_back(std::make_unique<EmbreeSingle>("embree 1, high", Role::embree_single, built(kHigh, false, false)));
    list.push_back(std::make_unique<EmbreeSingle>("embree 1, high, robust", Role::embree_robust, robust));
    list.push_back(std::make_unique<EmbreePackets>("embree 16, high", Role::embree_wide, wide));
    list.push_back(std::make_unique<EmbreePackets>("embree 16, high, robust", Role::embree_wide, built(kHigh, true, true)));
    if (wide->has_streams()) list.push_back(std::make_unique<EmbreeStreams>("embree stream, high", Role::embree_wide, wide));
    return list;
}

}  // namespace glint::bench
