"""The look of a report's page."""
STYLE = """
:root { --ink: #22303c; --quiet: #5b6872; --rule: #dde3e7; --panel: #f6f8f9; --accent: #0b5a8a; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0; background: #fff; color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 2.2rem 1.2rem 3rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .3rem; letter-spacing: -.01em;
  overflow-wrap: anywhere; }
h2 { font-size: 1.25rem; margin: 3rem 0 .5rem; padding-top: .9rem; border-top: 1px solid var(--rule); }
h3 { font-size: 1rem; margin: 1.6rem 0 .3rem; }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
.over { color: var(--accent); font-size: .8rem; font-weight: 600; letter-spacing: .08em;
  text-transform: uppercase; margin: 0 0 .4rem; }
.verdict { display: inline-block; margin: .6rem 0 0; padding: .3rem .8rem; border-radius: 1rem;
  font-weight: 600; }
.same { background: #e4f3ec; color: #0c5d3f; }
.differs { background: #fbe8e2; color: #932b0c; }
.heeded { background: #fff6e0; color: #7a5200; }
.note { background: #fff6e0; border-left: 3px solid #d99a1c; padding: .5rem .9rem; }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(8.6rem, 1fr)); gap: 1px;
  margin: 1.5rem 0 1.2rem; border: 1px solid var(--rule); border-radius: .5rem; overflow: hidden; }
.facts div { padding: .7rem .9rem; box-shadow: 0 0 0 1px var(--rule); }
.facts dt { color: var(--quiet); font-size: .82rem; }
.facts dd { margin: 0; font-size: 1.15rem; font-weight: 600; font-variant-numeric: tabular-nums; }
figure { margin: 1rem 0 1.4rem; break-inside: avoid; }
figcaption { font-size: .92rem; color: var(--ink); max-width: 46rem; margin-top: .35rem; }
figcaption small { color: var(--quiet); font-size: 1em; }
img { display: block; width: 100%; height: auto; }
.wide { overflow-x: auto; }
.key { margin: .4rem 0 .6rem; }
.frames { display: grid; grid-template-columns: repeat(auto-fill, minmax(17rem, 1fr)); gap: 1.1rem 1rem; }
.frames figure { margin: 0; }
.frames figcaption { font-size: .82rem; color: var(--quiet); font-variant-numeric: tabular-nums;
  margin-top: .1rem; }
table { border-collapse: collapse; font-size: .92rem; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .32rem .6rem .32rem 0;
  border-bottom: 1px solid var(--rule); }
th { font-weight: 400; color: var(--quiet); width: 45%; }
td { font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 0 2.4rem; }
table.many { width: auto; font-size: .84rem; }
.many th, .many td { width: auto; padding-right: 1.2rem; white-space: nowrap; }
code { font: .88em ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; overflow-wrap: anywhere; }
.flows .many th, .flows .many td { padding-right: .8rem; font-size: .8rem; }
.strips figure { margin: .3rem 0 1rem; }
.strips figcaption { font-size: .84rem; max-width: none; margin-top: 0; }
footer { margin-top: 3rem; padding-top: .8rem; border-top: 1px solid var(--rule); color: var(--quiet);
  font-size: .85rem; }
@media (max-width: 40rem) { main { padding-top: 1.3rem; }
  .wide img[src] { min-width: 34rem; }
  .key img[src] { min-width: 0; }
  .two { grid-template-columns: 1fr; } }
@media print { body { font-size: 10pt; } main { max-width: none; padding: 0; }
  h2, h3 { break-after: avoid; } h2 { margin-top: 1.4rem; } h2 + p { break-after: avoid; }
  .wide { overflow: visible; }
  .many th, .many td, .flows .many th, .flows .many td { font-size: 7pt; padding-right: .4rem; }
  .frames { grid-template-columns: repeat(3, 1fr); } .two { grid-template-columns: 1fr 1fr; }
  tr { break-inside: avoid; } @page { margin: 16mm; } }
"""
