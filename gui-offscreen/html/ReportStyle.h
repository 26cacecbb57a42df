#pragma once

namespace perception {

/// CSS of the report page.
inline constexpr const char* kReportStyle = R"css(
:root { --ink: #141414; --paper: #fff; --pale: #555; --line: #ccc; --link: #0072b2;
        --hover: #f1f6fa; --warning: #fdf0e3; }
body { font: 15px/1.45 system-ui, "DejaVu Sans", sans-serif; color: var(--ink); background: var(--paper);
       max-width: 1180px; margin: 24px auto; padding: 0 16px; }
h1 { font-size: 26px; margin: 0 0 8px; }
h2 { font-size: 20px; margin: 36px 0 8px; }
h3 { font-size: 16px; margin: 24px 0 4px; }
.lead { font-size: 17px; }
.tiles { display: flex; flex-wrap: wrap; margin: 12px -6px; }
.tile { margin: 6px; border: 1px solid var(--line); border-radius: 6px; padding: 10px 14px; width: 132px; }
.tile b { display: block; font-size: 22px; }
.tile span { color: var(--pale); font-size: 13px; }
figure { margin: 0; }
figure img, figure video { width: 100%; border: 1px solid var(--line); }
figcaption { color: var(--pale); font-size: 14px; }
table { border-collapse: collapse; display: block; overflow-x: auto; }
td, th { border-bottom: 1px solid var(--line); padding: 3px 12px 3px 0; text-align: left; }
th { font-weight: 600; }
tr[data-id] td { white-space: nowrap; }
svg { width: 100%; cursor: pointer; }
svg text { font-size: 11px; fill: var(--ink); }
svg .grid { stroke: var(--line); }
#now { stroke: var(--ink); stroke-width: 2; }
.legend span { margin-right: 18px; }
.legend i { display: inline-block; width: 14px; height: 12px; margin-right: 5px; }
)css";

}  // namespace perception
