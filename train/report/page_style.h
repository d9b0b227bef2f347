#pragma once

#include <string_view>

namespace vkopple {

/// The report's style sheet: light or dark as the reader's system is, one column on narrow screens.
inline constexpr std::string_view kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --paper: #fdfdfb; --ink: #1d1d1b; --quiet: #66665f; --rule: #dcdcd4; --shade: #f3f3ee;
  --first: #1f5fa8; --second: #b4500a; --band: #1f5fa833;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #171716; --ink: #e7e7e1; --quiet: #a0a098; --rule: #3a3a36; --shade: #20201e;
    --first: #7fb6f2; --second: #f0a45d; --band: #7fb6f240;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 1.5rem 1rem 4rem; max-width: 70rem;
  background: var(--paper); color: var(--ink);
  font: 1rem/1.5 Charter, "Bitstream Charter", Cambria, Georgia, serif;
}
h1 { margin: 0 0 .25rem; font-size: 1.7rem; font-weight: 600; line-height: 1.2; overflow-wrap: anywhere; }
h2 { margin: 3rem 0 .5rem; padding-top: .6rem; border-top: 1px solid var(--rule); font-size: 1.25rem; font-weight: 600; }
h3 { margin: 1.75rem 0 .25rem; font-size: 1rem; font-weight: 600; }
p { margin: .5rem 0; max-width: 44rem; overflow-wrap: anywhere; }
.quiet, figcaption { color: var(--quiet); }
.note { padding-left: .75rem; border-left: 3px solid var(--second); }
nav { margin: 1rem 0 0; display: flex; flex-wrap: wrap; gap: .15rem 1.1rem; }
a { color: var(--first); text-decoration: none; }
a:hover, a:focus { text-decoration: underline; }
figure { margin: 0; min-width: 0; }
figcaption { font-size: .85rem; line-height: 1.4; max-width: 44rem; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 19rem), 1fr)); gap: 1.25rem 1.5rem; margin: 1rem 0; }
.small { grid-template-columns: repeat(auto-fill, minmax(min(100%, 9.5rem), 1fr)); }
svg { display: block; width: 100%; max-width: 26rem; height: auto; }
svg text { fill: var(--quiet); font: 11px system-ui, sans-serif; font-variant-numeric: tabular-nums; }
svg .title { fill: var(--ink); }
svg .guide { stroke: var(--rule); fill: none; }
svg .dashed { stroke: var(--quiet); stroke-dasharray: 3 3; fill: none; }
svg .band { fill: var(--band); }
svg .line { fill: none; stroke: var(--first); stroke-width: 1.5; stroke-linejoin: round; }
svg .dot { fill: var(--first); }
svg .faint { fill: none; stroke: var(--first); opacity: .6; }
svg .ring { fill: none; stroke: var(--second); stroke-width: 1.5; }
svg .link { stroke: var(--quiet); stroke-width: .75; opacity: .6; }
svg .mark { stroke: var(--second); stroke-width: 2.5; }
svg .camera { fill: var(--ink); }
.key { white-space: nowrap; }
.key svg { display: inline-block; width: 1.6em; height: .8em; vertical-align: baseline; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .75rem 0; font-variant-numeric: tabular-nums lining-nums; }
th, td { padding: .2rem 1.25rem .2rem 0; text-align: left; vertical-align: baseline; font-weight: normal; }
thead th { border-bottom: 1px solid var(--ink); color: var(--quiet); font-size: .85rem; }
tbody tr + tr > * { border-top: 1px solid var(--rule); }
td.number, th.number { text-align: right; padding-right: 0; padding-left: 1.5rem; white-space: nowrap; }
.words td { overflow-wrap: anywhere; }
.pictures { display: grid; gap: .35rem; margin: 1rem 0; }
.pictures .row { display: grid; gap: .35rem; grid-template-columns: repeat(var(--columns), minmax(0, 11rem)); }
.pictures .row > * { min-width: 0; }
.pictures .head { color: var(--quiet); font-size: .85rem; line-height: 1.2; align-items: end; }
.pictures figcaption { margin-bottom: .75rem; }
img { display: block; width: 100%; height: auto; image-rendering: pixelated; }
.below { display: none; color: var(--quiet); font-size: .8rem; line-height: 1.2; }
pre { margin: .5rem 0; padding: .75rem; overflow-x: auto; background: var(--shade); font: .82rem/1.45 ui-monospace, "DejaVu Sans Mono", monospace; }
.wrap { white-space: pre-wrap; overflow-wrap: anywhere; }
summary { cursor: pointer; }
@media (max-width: 40rem) {
  .pictures .row { grid-template-columns: repeat(var(--narrow), minmax(0, 1fr)); }
  .pictures .head { display: none; }
  .pictures .below { display: block; }
  th, td { padding-right: .75rem; }
}
)css";

}  // namespace vkopple
