/* selvage session: what is painted, undone and exported is there, run by run. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <sys/stat.h>

#include <selvage/file.h>

static const char box[] = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 2\nv 2 0 2\nv 2 1 2\nv 0 1 2\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
static const char script[] =
    "{\"op\":\"set\",\"color\":[1,0,0],\"radius\":0.3}\n"
    "{\"samples\":[[1,0.2,0.5],[1,0.8,0.5]]}\n# a comment\n{\"op\":\"fill\",\"face\":3}\n";

/* What a session was made of is not written over, however it is named; nor is what it consists of.
 */
static void check_kept(void) {
    RUNS(0, "convert in.ptx kept.ptx");
    REQUIRE(symlink("in.ptx", tool_path("link.ptx")) == 0);
    static const char *const lost[] = {"in.ptx", "./in.ptx", "link.ptx"};
    for (size_t i = 0; i < sizeof lost / sizeof *lost; i++) {
        RUNS(1, "session s.selvage --script s.jsonl --export %s", lost[i]);
        HAS("would be lost");
        RUNS(1, "paint s.selvage s.jsonl %s", lost[i]);
        HAS("would be lost");
    }
    RUNS(0, "diff in.ptx kept.ptx");
    RUNS(0, "paint in.ptx s.jsonl painted.selvage -q");
    RUNS(1, "session painted.selvage -o in.ptx");
    HAS("would be lost");
    RUNS(0, "session again.selvage --replay painted.selvage -q");
    RUNS(1, "session again.selvage -o in.ptx");
    tool_write_file("s.selvage/texture-9-0.ptx", "old", 3);
    RUNS(1, "session s.selvage -o s.selvage/texture-9-0.ptx");
    HAS("s.selvage/texture-9-0.ptx: is part of the session s.selvage");
    RUNS(0, "session s.selvage");
    HAS("3 lines, 0 since");
    test_remove(tool_path("again.selvage"));
}

/* A script says of a layer what it cares for. */
static void check_layers(void) {
    static const char layers[] = "{\"op\":\"add-layer\",\"name\":\"top\",\"blend\":\"multiply\"}\n"
                                 "{\"op\":\"set-layer\",\"layer\":3,\"opacity\":0.5}\n";
    static const struct {
        const char *line, *says;
    } wrong[] = {
        {"{\"op\":\"add-layer\",\"nam\":\"x\"}", "unknown key 'nam'; did you mean 'name'?"},
        {"{\"op\":\"add-layers\"}", "did you mean 'add-layer'?"},
        {"{\"op\":\"undo\",\"count\":2}", "unknown key 'count'"},
        {"{\"op\":\"group\",\"name\":\"x\"}", "edits: expected a list"},
        {"{\"op\":\"fill\",\"face\":1,\"layer\":1,\"mask\":1}", "mask: expected true or false"},
        {"{\"op\":\"fill\",\"face\":1,\"mask\":true}", "there is no mask of layer 3"},
        {"{\"op\":\"add-layer\",\"above\":\"x\"}", "above: expected the id of the layer below"},
        {"{\"op\":\"set-layer\",\"layer\":3,\"blend\":7}", "blend: expected normal, multiply"},
        {"{\"op\":\"set-layer\",\"layer\":3,\"hidden\":1}", "hidden: expected true or false"},
        {"{\"op\":\"set-layer\",\"opacity\":0}", "layer: expected a layer's id"}};
    RUNS(0, "session layers.selvage --new in.ptx -q");
    tool_write_file("layers.selvage/journal", "{}\n{}\n", 6);
    RUNS(0, "session layers.selvage");
    HAS("layers.selvage/journal: is damaged after line 0");
    HAS("kept in layers.selvage/journal-damaged");
    tool_write_file("l.jsonl", layers, sizeof layers - 1);
    RUNS(0, "session layers.selvage --script l.jsonl");
    HAS("3 layers");
    slv_env env = test_env();
    char *text = NULL;
    size_t size;
    MUST(slv_text_load(&env, tool_path("layers.selvage/journal"), &text, &size));
    CHECK(strstr(text, "\"name\":\"top\",\"opacity\":1.0,\"blend\":\"multiply\",\"hidden\":false"));
    CHECK(strstr(text, "\"name\":\"top\",\"opacity\":0.5,\"blend\":\"multiply\",\"hidden\":false"));
    slv_free(text);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        tool_write_file("l.jsonl", wrong[i].line, strlen(wrong[i].line));
        RUNS(1, "session layers.selvage --script l.jsonl");
        HAS("l.jsonl: line 1: ");
        HAS(wrong[i].says);
    }
}

/* The layer, or mask, that is set is painted on, and is when the journal is done again. */
static void check_set(void) {
    static const char lines[] =
        "{\"op\":\"add-mask\",\"layer\":1,\"value\":1}\n"
        "{\"op\":\"set\",\"layer\":1,\"mask\":true,\"radius\":0.4,\"color\":[0]}\n"
        "{\"samples\":[[1,0.5,0.5]]}\n"
        "{\"layer\":2,\"color\":[1,0,0],\"samples\":[[2,0.5,0.5]]}\n"
        "{\"op\":\"set\",\"layer\":2}\n{\"op\":\"fill\",\"face\":4,\"color\":[0,0,1]}\n";
    static const char named[] =
        "{\"op\":\"add-mask\",\"layer\":1,\"value\":1}\n"
        "{\"layer\":1,\"mask\":true,\"radius\":0.4,\"color\":[0],\"samples\":[[1,0.5,0.5]]}\n"
        "{\"layer\":2,\"radius\":0.4,\"color\":[1,0,0],\"samples\":[[2,0.5,0.5]]}\n"
        "{\"layer\":2,\"op\":\"fill\",\"face\":4,\"color\":[0,0,1]}\n";
    RUNS(0, "session set.selvage --new in.ptx -q");
    tool_write_file("l.jsonl", lines, sizeof lines - 1);
    RUNS(0, "session set.selvage --script l.jsonl -o set.ptx -q");
    RUNS(0, "session set.selvage -o again.ptx -q");
    RUNS(0, "diff set.ptx again.ptx");
    RUNS(0, "session named.selvage --new in.ptx -q");
    tool_write_file("l.jsonl", named, sizeof named - 1);
    RUNS(0, "session named.selvage --script l.jsonl -o named.ptx -q");
    RUNS(0, "diff set.ptx named.ptx");
    RUNS(1, "diff in.ptx set.ptx");
}

/* Seams of a session: of what it shows, of each layer, and of two of them. */
static void check_seams(void) {
    static const char line[] = "{\"op\":\"fill\",\"face\":3,\"color\":[1,0,0]}\n# no entry\n"
                               "{\"op\":\"fill\",\"face\":3,\"color\":[0,0,0]}\n";
    RUNS(0, "session seams.selvage --new in.ptx --scheme bilinear --certify");
    HAS("seams before: at most 0 apart");
    HAS("seams of layer 1: at most 0 apart");
    tool_write_file("l.jsonl", line, sizeof line - 1);
    RUNS(0, "session seams.selvage --script l.jsonl --certify --between 1,2");
    HAS("seams after line 1: at most 0.");
    HAS("seams after line 3: at most 0.");
    LACKS("line 2");
    HAS("seams of layer 1: at most 0 apart");
    HAS("seams of layer 2: at most 1 apart");
    HAS("seams between layers 1 and 2: at most");
    RUNS(0, "session seams.selvage --certify --between 2,1 --json");
    HAS("\"of\": \"between layers 2 and 1\"");
    RUNS(1, "session seams.selvage --certify --between 2,7");
    HAS("7");
    RUNS(2, "session seams.selvage --between 2,1");
    RUNS(2, "session seams.selvage --certify --between 2");
    RUNS(2, "session seams.selvage --certify --between 2,1,3");
}

/* What is open already, or cannot be done again, is named. */
static void check_lost(void) {
    RUNS(1, "session other.selvage --merge other.selvage");
    HAS("is open already");
    RUNS(0, "session lost.selvage --new in.ptx -q");
    const char *load = "{\"op\":\"load\",\"layer\":2,\"file\":\"in.ptx\"}\n";
    tool_write_file("l.jsonl", load, strlen(load));
    RUNS(0, "session lost.selvage --script l.jsonl -q");
    REQUIRE(unlink(tool_path("lost.selvage/texture-4-0.ptx")) == 0);
    RUNS(1, "session lost.selvage");
    HAS("line 4 cannot be done now (lost.selvage/texture-4-0.ptx: No such file");
    HAS("--as-saved");
    RUNS(0, "session lost.selvage --as-saved");
    REQUIRE(unlink(tool_path("lost.selvage/journal")) == 0);
    RUNS(0, "session lost.selvage");
    HAS("lost.selvage/journal: is missing");
    HAS("2 layers");
    RUNS(0, "session lost.selvage");
    LACKS("missing"); /* it is there again */
}

/* What may only be read can be looked at, exported and certified, and nothing else. */
static void read_only(void) {
    RUNS(0, "session read.selvage --new in.ptx --scheme bilinear -q");
    RUNS(0, "session read.selvage --script s.jsonl --export written.ptx -q");
    REQUIRE(chmod(tool_path("read.selvage/journal"), 0444) == 0);
    REQUIRE(chmod(tool_path("read.selvage"), 0555) == 0 && chmod(test_folder, 0777) == 0);
    fflush(NULL);
    pid_t child = fork(); /* as one who is not above permissions */
    REQUIRE(child >= 0);
    if (child == 0) {
        if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0))
            _exit(0);
        RUNS(0, "session read.selvage --certify");
        HAS("2 since it was saved");
        HAS("seams after");
        RUNS(0, "session read.selvage --export read.ptx -q");
        RUNS(0, "paint read.selvage s.jsonl painted.ptx -q");
        RUNS(1, "session read.selvage --script s.jsonl");
        HAS("Permission denied");
        RUNS(1, "session read.selvage --undo 1");
        HAS("Permission denied");
        fflush(NULL);
        _exit(test_end() != 0);
    }
    int status = 1;
    CHECK(waitpid(child, &status, 0) == child && status == 0);
    if (access(tool_path("read.ptx"), F_OK) == 0)
        RUNS(0, "diff written.ptx read.ptx");
    REQUIRE(chmod(tool_path("read.selvage"), 0755) == 0);
}

int main(void) {
    tool_begin();
    tool_write_file("box.obj", box, sizeof box - 1);
    tool_write_file("s.jsonl", script, sizeof script - 1);
    tool_write_file("wrong.jsonl", "{\"op\":\"fill\",\"face\":2}\n{\"op\":\"fill\",\"face\":99}\n",
                    47);
    RUNS(0, "new box.obj in.ptx --size 16 --scheme bilinear");
    check_seams();
    check_set();
    RUNS(0, "session s.selvage --new in.ptx --scheme bilinear");
    HAS("6 faces, 2 layers, 3 lines, 0 since it was saved");
    RUNS(1, "session s.selvage --new in.ptx");
    HAS("is there already");
    RUNS(0, "session s.selvage --export first.ptx");
    RUNS(0, "diff in.ptx first.ptx");
    check_kept();
    RUNS(0, "session s.selvage --script s.jsonl --export out.ptx");
    HAS("5 lines, 2 since");
    RUNS(1, "diff first.ptx out.ptx");
    RUNS(0, "session s.selvage --undo 2 --export undone.ptx --json");
    HAS("\"recovered\": 2");
    RUNS(0, "diff first.ptx undone.ptx");
    RUNS(0, "session s.selvage --undo 0");
    HAS("7 lines");
    RUNS(1, "session s.selvage --undo 1");
    HAS("1 to undo, of 0 that there are");
    RUNS(1, "session s.selvage --redo 3");
    HAS("3 to redo, of 2 that there are");
    RUNS(0, "session s.selvage");
    HAS("7 lines"); /* nothing was done by halves */
    /* what was undone can be redone in another process */
    RUNS(0, "session s.selvage --redo 2 --export redone.ptx");
    RUNS(0, "diff out.ptx redone.ptx");
    RUNS(0, "session s.selvage --undo 2");
    HAS("0 to undo, 2 to redo");
    check_layers();
    RUNS(0, "session s.selvage --script s.jsonl --save --edits undone.ptx");
    HAS("2 faces appended");
    RUNS(0, "session s.selvage --edits undone.ptx");
    HAS("0 faces appended");
    RUNS(1, "session s.selvage --script wrong.jsonl");
    HAS("selvage: wrong.jsonl: line ");
    HAS("face: expected the number of a face");
    RUNS(0, "session s.selvage");
    HAS("1 since it was saved");
    RUNS(0, "session s.selvage --as-saved --export saved.ptx");
    RUNS(0, "diff out.ptx saved.ptx");
    RUNS(0, "session other.selvage --new in.ptx --scheme bilinear");
    RUNS(0, "session other.selvage --merge s.selvage --json");
    HAS("\"merged_faces\": 2");
    RUNS(0, "session other.selvage --export merged.ptx");
    RUNS(0, "diff out.ptx merged.ptx");
    check_lost();
    read_only();
    /* all of it again, from the samples, and at twice the resolution */
    RUNS(0, "session again.selvage --replay s.selvage --export again.ptx");
    HAS("6 faces, 2 layers");
    RUNS(0, "diff saved.ptx again.ptx");
    RUNS(0, "session large.selvage --replay s.selvage --scale 2 --export large.ptx");
    RUNS(0, "session large.selvage --export reopened.ptx -q");
    RUNS(0, "diff large.ptx reopened.ptx");
    RUNS(0, "new box.obj blank32.ptx --size 32 --scheme bilinear -q");
    RUNS(0, "session direct.selvage --new blank32.ptx --scheme bilinear -q");
    RUNS(0, "session direct.selvage --script s.jsonl -o direct.ptx -q");
    RUNS(0, "diff large.ptx direct.ptx");
    RUNS(1, "session large.selvage --replay s.selvage");
    HAS("is there already");
    RUNS(1, "session huge.selvage --replay s.selvage --scale 65536");
    HAS("face 0 would have");
    CHECK(access(tool_path("huge.selvage"), F_OK) != 0);
    RUNS(2, "session x.selvage --scale 2");
    RUNS(2, "session x.selvage --replay s.selvage --scale 3");
    RUNS(1, "session missing.selvage");
    HAS("missing.selvage");
    RUNS(2, "session");
    RUNS(1, "session s.selvage --layer 9 --script s.jsonl");
    HAS("no layer 9");
    tool_end();
    return test_end();
}
