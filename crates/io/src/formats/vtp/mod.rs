//! VTK XML: all pieces of a `.vtp` (PolyData) or `.vtu` (UnstructuredGrid) file. Arrays are text,
//! base64 or appended (raw or base64), with or without zlib.
//!
//! The size is an array named `radius`, `r`, `diameter` or `d`, of the points or of cells that are
//! one point each. Points joined by polygons or larger cells are refused. Format:
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

mod numbers;

use anyhow::{Context, bail, ensure};

use crate::formats::xml::{Base64, Tag, Xml};
use crate::raw::arrays::{Arrays, Cells, Of};
use crate::raw::lines::{Source, short};
use crate::raw::room::{numbered, room};
use crate::raw::scalars::{Kind, Target};
use crate::{Loaded, Options};
use numbers::{Array, Counting, Layout, numbers, text};

struct File<'a> {
    xml: Xml<'a>,
    options: Options,
    layout: Layout,
    pieces: Vec<Arrays>,
    announced: u64,
    points: u64,
    cells: u64,
    within: String,
    /// Name of the array of ids, if the tag named in `within` gives one.
    ids: Option<String>,
    /// Arrays whose numbers come after all tags: offset, index of the piece, and array.
    appended: Vec<(u64, usize, Array)>,
}

pub fn read(source: Source<'_>, options: Options) -> anyhow::Result<Loaded> {
    let name = source.name;
    let mut file = File {
        xml: Xml { source, line: 1 },
        options,
        layout: Layout::default(),
        pieces: Vec::new(),
        announced: 0,
        points: 0,
        cells: 0,
        within: String::new(),
        ids: None,
        appended: Vec::new(),
    };
    file.kind()?;
    let mut ended = false;
    while !ended && let Some(tag) = file.xml.tag()? {
        match (tag.name.as_str(), tag.closing) {
            ("VTKFile", true) => ended = true,
            ("AppendedData", false) => {
                file.behind(tag.get("encoding") == Some("raw"))?;
                ended = true;
            }
            ("Piece", false) => file.piece(&tag)?,
            ("DataArray", false) => file.array(&tag)?,
            (
                "Points" | "PointData" | "CellData" | "Cells" | "Verts" | "Lines" | "Strips"
                | "Polys" | "FieldData",
                closing,
            ) => {
                file.within = if closing || tag.empty { String::new() } else { tag.name.clone() };
                file.ids = tag.get("GlobalIds").map(str::to_string);
            }
            _ => {}
        }
    }
    ensure!(file.appended.is_empty(), "{name} ends before its AppendedData; write it again");
    ensure!(ended, "{name} ends before </VTKFile>; write it again");
    let mut all = Arrays::default();
    for piece in file.pieces {
        all.append(piece)?;
    }
    let (particles, about) = all.particles("VTK XML", name, options)?;
    ensure!(
        file.announced == particles.len() as u64,
        "{name} announces {} points, but holds {}; write it again",
        file.announced,
        particles.len()
    );
    Ok((particles, about))
}

impl File<'_> {
    fn kind(&mut self) -> anyhow::Result<()> {
        let tag = self.xml.tag()?;
        let place = self.xml.place();
        let tag = tag.with_context(|| format!("{place}: there is no tag <VTKFile>"))?;
        ensure!(
            tag.name == "VTKFile",
            "{place}: '<{}' does not start a VTK XML file",
            short(&tag.name)
        );
        match tag.get("type").unwrap_or_default() {
            "PolyData" | "UnstructuredGrid" => {}
            kind @ ("Collection" | "PPolyData" | "PUnstructuredGrid") => bail!(
                "{place}: a VTK file of type '{kind}' names others beside it, and is read where \
                 it is given as a file, uncompressed"
            ),
            kind => bail!(
                "{place}: a VTK file of type '{}' is not read; write PolyData (.vtp)",
                short(kind)
            ),
        }
        self.layout = Layout {
            big: tag.get("byte_order") == Some("BigEndian"),
            header: if tag.get("header_type") == Some("UInt64") { 8 } else { 4 },
            compressor: tag.get("compressor").unwrap_or_default().to_string(),
        };
        Ok(())
    }

    fn piece(&mut self, tag: &Tag) -> anyhow::Result<()> {
        let place = self.xml.place();
        let number = |key: &str| tag.get(key).and_then(|n| n.trim().parse::<u64>().ok());
        let n = number("NumberOfPoints");
        let n = n.with_context(|| format!("{place}: the piece has no NumberOfPoints"))?;
        self.announced = self.announced.saturating_add(n);
        numbered(self.announced, "points", &place)?;
        let [vertices, lines, strips, polygons, others] =
            ["NumberOfVerts", "NumberOfLines", "NumberOfStrips", "NumberOfPolys", "NumberOfCells"]
                .map(|key| number(key).unwrap_or(0));
        let faces = strips.saturating_add(polygons);
        let cells = Cells { lines, faces, bodies: 0 };
        let all = [vertices, lines, faces, others].into_iter().fold(0, u64::saturating_add);
        (self.points, self.cells) = (n, all);
        room(&mut self.pieces)?;
        self.pieces.push(Arrays::of(cells));
        Ok(())
    }

    fn target(&mut self, tag: &Tag, kind: Kind) -> anyhow::Result<(Target, Option<u64>)> {
        let options = self.options;
        let Some(piece) = self.pieces.last_mut() else { return Ok((Target::Nothing, None)) };
        let (label, components) = (tag.get("Name").unwrap_or_default(), components(tag));
        let (target, count) = match self.within.as_str() {
            "Points" => {
                ensure!(components == 3, "Points have {components} components; 3 are needed");
                (Target::points(), Some(self.points))
            }
            "PointData" => {
                let is_id = self.ids.as_deref() == Some(label);
                let label = if is_id { "GlobalIds" } else { label };
                let target = piece.target(Of::Points, label, kind, components, options)?;
                (target, Some(self.points))
            }
            "CellData" => {
                let target = piece.target(Of::Cells, label, kind, components, options)?;
                (target, Some(self.cells))
            }
            "Cells" if label == "types" => (Target::Types(Cells::default()), Some(self.cells)),
            "Cells" | "Verts" if label == "connectivity" && piece.wants_cells(options) => {
                (Target::indices(false), None)
            }
            _ => (Target::Nothing, None),
        };
        Ok((target, count.map(|count| count.saturating_mul(components))))
    }

    fn array(&mut self, tag: &Tag) -> anyhow::Result<()> {
        let place = self.xml.place();
        let kind = Kind::named(tag.get("type").unwrap_or_default());
        // Unused arrays may have unknown types.
        let (target, count) =
            self.target(tag, kind.unwrap_or(Kind::F64)).with_context(|| place.clone())?;
        if let Target::Nothing = target {
            return Ok(());
        }
        let kind = kind.with_context(|| {
            format!(
                "{place}: numbers of type '{}' are not read; write Float32 or Float64",
                short(tag.get("type").unwrap_or_default())
            )
        })?;
        let array = Array { target, kind, count };
        let name = self.xml.source.name;
        let at = self.pieces.len().saturating_sub(1);
        let target = match tag.get("format").unwrap_or("ascii") {
            // Empty arrays may share an offset with others, and need not be read.
            "appended" if count == Some(0) => array.target,
            "appended" => {
                let offset = tag.get("offset").and_then(|offset| offset.parse().ok());
                let offset = offset
                    .with_context(|| format!("{place}: the array has no offset of its numbers"))?;
                room(&mut self.appended)?;
                self.appended.push((offset, at, array));
                return Ok(());
            }
            "ascii" if !tag.empty => text(&mut self.xml, array)?,
            "binary" if !tag.empty => {
                let unpacking = self.xml.source.unpacking;
                numbers(&mut Base64::new(&mut self.xml), unpacking, &self.layout, array)
                    .with_context(|| place)?
            }
            "ascii" | "binary" => {
                ensure!(count.unwrap_or(0) == 0, "{place}: the array is empty");
                array.target
            }
            other => bail!(
                "{place}: the format '{}' is neither ascii, binary nor appended",
                short(other)
            ),
        };
        self.pieces.last_mut().map_or(Ok(()), |piece| piece.keep(target, name))
    }

    fn behind(&mut self, raw: bool) -> anyhow::Result<()> {
        let mut list = std::mem::take(&mut self.appended);
        list.sort_by_key(|(offset, ..)| *offset);
        let File { xml, layout, pieces, .. } = self;
        let (name, unpacking) = (xml.source.name, xml.source.unpacking);
        while xml.take()?.with_context(|| format!("{name} ends before its appended numbers"))?
            != b'_'
        {}
        let mut at = 0;
        for (offset, piece, array) in list {
            let apart = offset.checked_sub(at).with_context(|| {
                format!("{name}: two arrays stand at the same offset; write it again")
            })?;
            ensure!(
                xml.source.skip(apart)?,
                "{name} ends before offset {offset} of its appended numbers; write it again"
            );
            at = offset;
            let what = || format!("{name}: the array at offset {offset}");
            let target = if raw {
                let mut bytes = Counting { inner: &mut *xml.source.input, count: 0 };
                let target = numbers(&mut bytes, unpacking, layout, array).with_context(what)?;
                at += bytes.count;
                target
            } else {
                let mut bytes = Base64::new(xml);
                let target = numbers(&mut bytes, unpacking, layout, array).with_context(what)?;
                at += bytes.letters();
                target
            };
            pieces[piece].keep(target, name)?;
        }
        Ok(())
    }
}

fn components(tag: &Tag) -> u64 {
    tag.get("NumberOfComponents").and_then(|k| k.parse().ok()).unwrap_or(1)
}
