/* Maps by texture coordinates beside per-face textures. */
#ifndef SELVAGE_TOOLS_REPORT_MAPS_H
#define SELVAGE_TOOLS_REPORT_MAPS_H

#include "compare/report/report_page.h"

/* Nothing if none were asked for. */
slv_result report_write_maps(const page *p);

#endif
