// Of uPlot, what panel/truth.js uses: for the type check.
type Columns = ArrayLike<number>[];

export default class uPlot {
  constructor(options: object, data: Columns, box: HTMLElement);
  readonly width: number;
  readonly data: Columns;
  readonly cursor: { idx?: number | null };
  setData(data: Columns): void;
  setLegend(values: { idx: number }): void;
  setSize(size: { width: number; height: number }): void;
  destroy(): void;
}
