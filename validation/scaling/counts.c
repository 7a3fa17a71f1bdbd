/* Counts what each rank of an MPI program sends to others. To be loaded before the MPI library (LD_PRELOAD).

   COUNTS_FILE            the first rank writes the counts there when MPI ends, each as the largest of all ranks and the mean
   COUNTS_RANKS_PER_NODE  so many consecutive ranks count as a node: MPI_Comm_split_type gives these, and messages to other
                          ranks count as off the node; 0, the default, leaves the machine as it is

   Three kinds are counted apart: `sums`, collective calls on all ranks, as many messages each as a tree of the ranks has levels, and
   the barriers that end an exchange of lists; `halos`, messages between two ranks: lists, images, their sums, and migration;
   `groups`, those within a part of the ranks, as in the transpositions of a transform, where a message is a block of at least one
   value for one other rank.

   Ranks wait asleep, so that many of them can share a core. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { SUMS, HALOS, GROUPS };
enum { CALLS, MESSAGES, BYTES, OFF_NODE_MESSAGES, OFF_NODE_BYTES };
static const char *const KINDS[] = {"sums", "halos", "groups"};
static const char *const NAMES[] = {"calls", "messages", "bytes", "off_node_messages", "off_node_bytes"};
static double counts[3][5];

static int ranks_per_node(void) {
    const char *text = getenv("COUNTS_RANKS_PER_NODE");
    return text ? atoi(text) : 0;
}

static int rank_in(MPI_Comm communicator) {
    int rank;
    PMPI_Comm_rank(communicator, &rank);
    return rank;
}

static int size_of(MPI_Comm communicator) {
    int size;
    PMPI_Comm_size(communicator, &size);
    return size;
}

/* The number in MPI_COMM_WORLD of a rank of a communicator. */
static int in_world(MPI_Comm communicator, int rank) {
    MPI_Group group, world;
    int number;
    if (communicator == MPI_COMM_WORLD) return rank;
    PMPI_Comm_group(communicator, &group);
    PMPI_Comm_group(MPI_COMM_WORLD, &world);
    PMPI_Group_translate_ranks(group, 1, &rank, world, &number);
    PMPI_Group_free(&group);
    PMPI_Group_free(&world);
    return number;
}

static void count(double *of, MPI_Comm communicator, int rank, int values, MPI_Datatype type) {
    int width, per_node = ranks_per_node();
    if (rank == rank_in(communicator) || values == 0) return;
    PMPI_Type_size(type, &width);
    of[MESSAGES] += 1;
    of[BYTES] += (double)values * width;
    if (per_node == 0 || in_world(communicator, rank) / per_node == rank_in(MPI_COMM_WORLD) / per_node) return;
    of[OFF_NODE_MESSAGES] += 1;
    of[OFF_NODE_BYTES] += (double)values * width;
}

static int kind_of(MPI_Comm communicator, int kind) { return communicator == MPI_COMM_WORLD ? kind : GROUPS; }

/* A collective call in which a rank sends so many bytes; to ranks off the node as many of its messages as of the others. */
static void count_tree(MPI_Comm communicator, double bytes) {
    double *of = counts[kind_of(communicator, SUMS)];
    int ranks = size_of(communicator), per_node = ranks_per_node(), levels = 0;
    for (int reached = 1; reached < ranks; reached *= 2) {
        levels += 1;
        if (per_node && reached >= per_node) of[OFF_NODE_MESSAGES] += 1;
    }
    of[CALLS] += 1;
    of[MESSAGES] += levels;
    of[BYTES] += bytes;
    if (per_node && ranks > per_node) of[OFF_NODE_BYTES] += bytes * (ranks - per_node) / ranks;
}

static double bytes_of(int values, MPI_Datatype type) {
    int width;
    PMPI_Type_size(type, &width);
    return (double)values * width;
}

static int asleep_until(MPI_Request *request) {
    int done = 0, error = MPI_SUCCESS;
    for (useconds_t pause = 100; error == MPI_SUCCESS && !done; pause = pause < 3200 ? 2 * pause : pause) {
        error = PMPI_Test(request, &done, MPI_STATUS_IGNORE);
        if (!done) usleep(pause);
    }
    return error;
}

int MPI_Alltoallv(const void *send, const int sent[], const int from[], MPI_Datatype type, void *receive,
                  const int received[], const int to[], MPI_Datatype received_type, MPI_Comm communicator) {
    MPI_Request request;
    double *of = counts[kind_of(communicator, HALOS)];
    of[CALLS] += 1;
    for (int rank = 0; rank < size_of(communicator); rank++) count(of, communicator, rank, sent[rank], type);
    PMPI_Ialltoallv(send, sent, from, type, receive, received, to, received_type, communicator, &request);
    return asleep_until(&request);
}

int MPI_Allgather(const void *send, int values, MPI_Datatype type, void *receive, int received, MPI_Datatype received_type,
                  MPI_Comm communicator) {
    MPI_Request request;
    count_tree(communicator, bytes_of(values, type) * (size_of(communicator) - 1));
    PMPI_Iallgather(send, values, type, receive, received, received_type, communicator, &request);
    return asleep_until(&request);
}

int MPI_Allgatherv(const void *send, int values, MPI_Datatype type, void *receive, const int received[], const int to[],
                   MPI_Datatype received_type, MPI_Comm communicator) {
    MPI_Request request;
    count_tree(communicator, bytes_of(values, type) * (size_of(communicator) - 1));
    PMPI_Iallgatherv(send, values, type, receive, received, to, received_type, communicator, &request);
    return asleep_until(&request);
}

int MPI_Gatherv(const void *send, int values, MPI_Datatype type, void *receive, const int received[], const int to[],
                MPI_Datatype received_type, int root, MPI_Comm communicator) {
    MPI_Request request;
    double *of = counts[kind_of(communicator, SUMS)];
    of[CALLS] += 1;
    count(of, communicator, root, values, type);
    PMPI_Igatherv(send, values, type, receive, received, to, received_type, root, communicator, &request);
    return asleep_until(&request);
}

int MPI_Bcast(void *data, int values, MPI_Datatype type, int root, MPI_Comm communicator) {
    MPI_Request request;
    if (rank_in(communicator) == root) count_tree(communicator, bytes_of(values, type));
    PMPI_Ibcast(data, values, type, root, communicator, &request);
    return asleep_until(&request);
}

int MPI_Allreduce(const void *send, void *receive, int values, MPI_Datatype type, MPI_Op operation, MPI_Comm communicator) {
    MPI_Request request;
    count_tree(communicator, bytes_of(values, type));
    PMPI_Iallreduce(send, receive, values, type, operation, communicator, &request);
    return asleep_until(&request);
}

int MPI_Ibarrier(MPI_Comm communicator, MPI_Request *request) {
    count_tree(communicator, 0);
    return PMPI_Ibarrier(communicator, request);
}

int MPI_Isend(const void *data, int values, MPI_Datatype type, int rank, int tag, MPI_Comm communicator,
              MPI_Request *request) {
    count(counts[kind_of(communicator, HALOS)], communicator, rank, values, type);
    return PMPI_Isend(data, values, type, rank, tag, communicator, request);
}

int MPI_Issend(const void *data, int values, MPI_Datatype type, int rank, int tag, MPI_Comm communicator,
               MPI_Request *request) {
    count(counts[kind_of(communicator, HALOS)], communicator, rank, values, type);
    return PMPI_Issend(data, values, type, rank, tag, communicator, request);
}

int MPI_Wait(MPI_Request *request, MPI_Status *status) {
    (void)status;
    return asleep_until(request);
}

int MPI_Improbe(int source, int tag, MPI_Comm communicator, int *found, MPI_Message *message, MPI_Status *status) {
    int error = PMPI_Improbe(source, tag, communicator, found, message, status);
    if (!*found) usleep(100);
    return error;
}

int MPI_Barrier(MPI_Comm communicator) {
    MPI_Request request;
    PMPI_Ibarrier(communicator, &request);
    return asleep_until(&request);
}

int MPI_Comm_split_type(MPI_Comm communicator, int type, int key, MPI_Info info, MPI_Comm *part) {
    if (ranks_per_node() == 0) return PMPI_Comm_split_type(communicator, type, key, info, part);
    return PMPI_Comm_split(communicator, rank_in(MPI_COMM_WORLD) / ranks_per_node(), key, part);
}

int MPI_Finalize(void) {
    const char *path = getenv("COUNTS_FILE");
    double most[3][5], sum[3][5];
    PMPI_Reduce(counts, most, 15, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
    PMPI_Reduce(counts, sum, 15, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    FILE *file = path && rank_in(MPI_COMM_WORLD) == 0 ? fopen(path, "w") : NULL;
    if (file) {
        for (int kind = 0; kind < 3; kind++)
            for (int name = 0; name < 5; name++)
                fprintf(file, "%s\"%s_%s\": [%.0f, %.3f]", kind + name ? ", " : "{", KINDS[kind], NAMES[name],
                        most[kind][name], sum[kind][name] / size_of(MPI_COMM_WORLD));
        fprintf(file, "}\n");
        fclose(file);
    }
    return PMPI_Finalize();
}
