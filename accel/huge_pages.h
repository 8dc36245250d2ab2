// An allocator for large arrays that are read at random: aligned to pages of 2 MB, which the kernel is asked to use, so that a
// visit to memory does not cost a second one for its address. Elements are left uninitialised unless they are given a value.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>

namespace glint {

template <class T>
struct HugePageAllocator {
    using value_type = T;
    HugePageAllocator() = default;
    template <class U>
    HugePageAllocator(const HugePageAllocator<U>&) noexcept {}  // NOLINT: conversion is the allocators' convention

    static constexpr std::size_t kPage = std::size_t{2} << 20;

    T* allocate(std::size_t n) {
        const std::size_t bytes = n * sizeof(T);
        // Small arrays stay small; only from a page on is a page of 2 MB worth its size.
        const std::size_t alignment = bytes >= kPage ? kPage : alignof(T) > 64 ? alignof(T) : 64;
        void* p = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
        if (p == nullptr) throw std::bad_alloc();
        if (bytes >= kPage) madvise(p, bytes, MADV_HUGEPAGE);  // advice: its failure changes nothing but speed
        return static_cast<T*>(p);
    }
    void deallocate(T* p, std::size_t) noexcept { std::free(p); }
    template <class U, class... Args>
    void construct(U* p, Args&&... args) {
        if constexpr (sizeof...(Args) == 0) {
            ::new (static_cast<void*>(p)) U;
        } else {
            ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
        }
    }
    bool operator==(const HugePageAllocator&) const { return true; }
};

}  // namespace glint
