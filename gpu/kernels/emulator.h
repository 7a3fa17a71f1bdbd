// Runs kernels on the host, for tests: the threads of a block are fibres, which run in an order that a seed shuffles
// anew after each barrier, and blocks run in a shuffled order.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <setjmp.h>
#include <string>
#include <ucontext.h>
#include <vector>

#define __global__
#define __device__

struct Index {
    unsigned x, y, z;
};
static Index threadIdx, blockIdx, blockDim;

namespace emulator {

constexpr size_t STACK = 1 << 16;
constexpr unsigned char UNSET = 0xff; // NaN as a number, -1 as an index

// A fibre runs one thread after the other, each to its end.
struct Fibre {
    ucontext_t context;
    jmp_buf place;
    std::vector<char> stack = std::vector<char>(STACK);
    size_t shared = 0;
    bool is_done = false, has_begun = false;
};

struct Shared {
    void *memory;
    size_t bytes;
};

static std::mt19937_64 shuffler;
static std::deque<Fibre> fibres;
static std::vector<Shared> shared_memory;
static Fibre *current;
static const std::function<void()> *body;

// Memory that the threads of a block share. The same call in each thread returns the same memory, which holds no
// values of an earlier block.
static void *shared(size_t bytes)
{
    size_t number = current->shared++;
    if (number == shared_memory.size()) {
        shared_memory.push_back({malloc(bytes), bytes});
        memset(shared_memory.back().memory, UNSET, bytes);
    }
    if (shared_memory[number].bytes != bytes) {
        fprintf(stderr, "threads of a block declare different shared memory\n");
        abort();
    }
    return shared_memory[number].memory;
}

#ifdef __SANITIZE_ADDRESS__
static ucontext_t scheduler;
static void barrier() { swapcontext(&current->context, &scheduler); }
static void resume(Fibre &fibre) { swapcontext(&scheduler, &fibre.context); }
#else
// Jumps between fibres, without the calls of the system that a change of contexts makes.
static jmp_buf scheduler;
static void barrier()
{
    if (_setjmp(current->place) == 0) _longjmp(scheduler, 1);
}
static __attribute__((noinline)) void resume(Fibre &fibre)
{
    if (_setjmp(scheduler) != 0) return;
    if (fibre.has_begun) _longjmp(fibre.place, 1);
    fibre.has_begun = true;
    setcontext(&fibre.context);
}
#endif

static void enter()
{
    for (;;) {
        (*body)();
        current->is_done = true;
        barrier();
    }
}

static void make(Fibre &fibre)
{
    getcontext(&fibre.context);
    fibre.context.uc_stack.ss_sp = fibre.stack.data();
    fibre.context.uc_stack.ss_size = fibre.stack.size();
    fibre.context.uc_link = nullptr;
    makecontext(&fibre.context, enter, 0);
}

// Runs each thread of a block to its next barrier, or to its end, until all have ended. As on a device, a thread that
// has ended no longer takes part in barriers.
static void run_block(unsigned threads, std::vector<unsigned> &order)
{
    for (unsigned thread = 0; thread < threads; thread++) fibres[thread].shared = 0, fibres[thread].is_done = false;
    for (bool any = true; any;) {
        any = false;
        std::shuffle(order.begin(), order.end(), shuffler);
        for (unsigned thread : order) {
            if (fibres[thread].is_done) continue;
            any = true;
            current = &fibres[thread];
            threadIdx = {thread, 0, 0};
            resume(*current);
        }
    }
    for (Shared &piece : shared_memory) free(piece.memory);
    shared_memory.clear();
}

static void launch(unsigned blocks, unsigned threads, const std::function<void()> &kernel)
{
    std::vector<unsigned> order(threads), block_order(blocks);
    std::iota(order.begin(), order.end(), 0u);
    std::iota(block_order.begin(), block_order.end(), 0u);
    std::shuffle(block_order.begin(), block_order.end(), shuffler);
    // Contexts point to themselves, so fibres keep their places.
    while (fibres.size() < threads) make(fibres.emplace_back());
    body = &kernel;
    blockDim = {threads, 1, 1};
    for (unsigned block : block_order) {
        blockIdx = {block, 0, 0};
        run_block(threads, order);
    }
}

} // namespace emulator

#define SHARED(type, name, count) type *name = (type *)emulator::shared(sizeof(type) * (count))

static void __syncthreads() { emulator::barrier(); }

template <typename N> static N atomicAdd(N *address, N value)
{
    N before = *address;
    *address += value;
    return before;
}

template <typename N> static N atomicMax(N *address, N value)
{
    N before = *address;
    *address = std::max(before, value);
    return before;
}

static long long __double_as_longlong(double value)
{
    long long bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static unsigned long long __umul64hi(unsigned long long a, unsigned long long b)
{
    return (unsigned long long)((unsigned __int128)a * b >> 64);
}
