#include "competitor.h"

namespace glint::bench {
namespace {

template <class A>
class OneByOne : public Competitor {
public:
    OneByOne(std::string name, Role role, std::shared_ptr<const A> accelerator)
        : Competitor(std::move(name), role), accelerator_(std::move(accelerator)) {}

    void closest(RayOrder, std::span<Block> blocks) const override {
        for (const Block& block : blocks) {
            for (std::size_t i = 0; i < block.rays.size(); ++i) {
                block.hits.set(static_cast<int>(i), accelerator_->closest_hit(block.rays[i]));
            }
        }
    }
    void occluded(RayOrder, std::span<Block> blocks) const override {
        for (const Block& block : blocks) {
            for (std::size_t i = 0; i < block.rays.size(); ++i) block.occluded[i] = accelerator_->occluded(block.rays[i]);
        }
    }

private:
    std::shared_ptr<const A> accelerator_;
};

class InBatches : public Competitor {
public:
    InBatches(std::string name, Role role, std::shared_ptr<const Bvh> bvh)
        : Competitor(std::move(name), role), bvh_(std::move(bvh)) {}

    void closest(RayOrder, std::span<Block> blocks) const override {
        for (const Block& block : blocks) bvh_->closest_hits(block.batch, block.hits);
    }
    void occluded(RayOrder, std::span<Block> blocks) const override {
        for (const Block& block : blocks) bvh_->occluded(block.batch, block.occluded);
    }

private:
    std::shared_ptr<const Bvh> bvh_;
};

}  // namespace

std::vector<Block> make_blocks(const RaySet& set, Answers& answers, std::size_t first, std::size_t last) {
    std::vector<Block> blocks;
    for (std::size_t b = first; b < last; ++b) {
        const std::size_t begin = b * kRayBatch, count = std::min<std::size_t>(kRayBatch, set.rays.size() - begin);
        blocks.push_back({std::span(set.rays).subspan(begin, count), set.batches[b], answers.hits[b], answers.occluded[b]});
    }
    return blocks;
}

void trace(const Competitor& competitor, const RaySet& set, Answers& answers) {
    std::vector<Block> blocks = make_blocks(set, answers, 0, answers.hits.size());
    competitor.begin_thread();
    if (set.any) {
        competitor.occluded(set.order, blocks);
    } else {
        competitor.closest(set.order, blocks);
    }
    competitor.end_thread();
}

Competitors glint_competitors(std::shared_ptr<const Bvh> bvh, std::shared_ptr<const Bvh> fast_tree,
                              std::shared_ptr<const UniformGrid> grid) {
    using Role = Competitor::Role;
    Competitors list;
    list.push_back(std::make_unique<OneByOne<Bvh>>("glint bvh, one ray", Role::bvh_single, bvh));
    list.push_back(std::make_unique<InBatches>("glint bvh, batches", Role::bvh_batch, std::move(bvh)));
    list.push_back(std::make_unique<InBatches>("glint bvh, fast tree, batches", Role::bvh_fast_tree, std::move(fast_tree)));
    if (grid) list.push_back(std::make_unique<OneByOne<UniformGrid>>("glint grid, one ray", Role::grid, std::move(grid)));
    return list;
}

}  // namespace glint::bench
