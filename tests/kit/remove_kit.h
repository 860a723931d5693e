/* What a test made, removed. */
#ifndef REMOVE_KIT_H
#define REMOVE_KIT_H

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file, a link, or a folder with all that is in it; nothing if it is not there. */
static inline void test_remove(const char *path) {
    struct stat status;
    if (lstat(path, &status) != 0)
        return;
    if (!S_ISDIR(status.st_mode)) {
        unlink(path);
        return;
    }
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        char inside[4096];
        int length = snprintf(inside, sizeof inside, "%s/%s", path, entry->d_name);
        if (length < (int)sizeof inside && strcmp(entry->d_name, ".") != 0 &&
            strcmp(entry->d_name, "..") != 0)
            test_remove(inside);
    }
    if (folder)
        closedir(folder);
    rmdir(path);
}

#endif
