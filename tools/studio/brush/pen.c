/* The log of a pen, played into the picture where the toolkit's events end: recorded tablets are
 * tried so where there is none. A line is `down`, `move` or `up`, milliseconds, x and y in pixels
 * of the picture, pressure, tilt x and y, and perhaps `eraser`. */
#include "studio/studio.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>

static void play_line(studio_app *app, const char *line) {
    static const char *const words[] = {"down", "move", "up"};
    char word[8] = "", last[8] = "";
    double ms = 0, x = 0, y = 0, pressure = 0, tilt[2] = {0};
    int n = sscanf(line, "%7s %lf %lf %lf %lf %lf %lf %7s", word, &ms, &x, &y, &pressure, &tilt[0],
                   &tilt[1], last);
    for (int i = 0; i < 3 && n >= 7; i++) {
        if (strcmp(word, words[i]) != 0)
            continue;
        const slv_stroke_sample sample = {.x = (float)x,
                                          .y = (float)y,
                                          .pressure = (float)pressure,
                                          .tilt_x = (float)tilt[0],
                                          .tilt_y = (float)tilt[1],
                                          .time = ms / 1000};
        if (app->document.texture && !app->loading)
            studio_stroke_pen(app, (studio_pen)i, &sample, i != STUDIO_PEN_UP,
                              strcmp(last, "eraser") == 0);
    }
}

static gboolean readable(GIOChannel *channel, GIOCondition condition, gpointer user) {
    char *line = NULL;
    GIOStatus status;
    (void)condition;
    do {
        status = g_io_channel_read_line(channel, &line, NULL, NULL, NULL);
        if (status == G_IO_STATUS_NORMAL && line)
            play_line(user, line);
        g_free(line);
        line = NULL;
    } while (status == G_IO_STATUS_NORMAL);
    return status == G_IO_STATUS_AGAIN;
}

void studio_pen_play(studio_app *app, const char *path) {
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) {
        studio_say(app, "The log of the pen cannot be read.", NULL, NULL);
        return;
    }
    GIOChannel *channel = g_io_channel_unix_new(file);
    g_io_channel_set_close_on_unref(channel, TRUE);
    g_io_channel_set_flags(channel, G_IO_FLAG_NONBLOCK, NULL);
    g_io_add_watch(channel, G_IO_IN | G_IO_HUP, readable, app);
    g_io_channel_unref(channel);
}
