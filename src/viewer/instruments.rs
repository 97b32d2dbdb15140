//! Values, parameters and geoms that a controller or a program shows in the window.

use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::controller::Controller;
use crate::data::Data;
use crate::error::{Outcome, Result};
use crate::scene::{Connector, NewGeom};
use crate::viewer::signal::Signal;

/// Value of a curve in a plot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlottedValue {
    /// Title of the plot.
    pub plot: Arc<str>,
    pub name: Arc<str>,
    pub signal: Signal,
}

/// Number that the user can change with a slider.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parameter {
    pub name: Arc<str>,
    pub value: f64,
    pub range: [f64; 2],
}

/// Instruments of a controller in the window: plotted values, parameters with sliders, and geoms
/// such as the path of a plan.
///
/// A closure declares all instruments each time it is called, with
/// [`Viewer::with_instrumented_controller`](super::Viewer::with_instrumented_controller) or
/// [`ViewerHandle::instruments`](super::ViewerHandle::instruments). An instrument that the closure
/// does not declare again disappears from the next image. The plots and the sliders are at the top
/// of the right panel; Shift+F3 hides and shows them.
///
/// The closure runs in the thread of the controller, which therefore needs no locks. The
/// declarations allocate memory only when they change: another name, or more values, parameters or
/// geoms than before.
///
/// ```no_run
/// use mujoco_safe::scene::NewGeom;
/// use mujoco_safe::viewer::{Viewer, ViewerError};
/// use mujoco_safe::{Controller, Data, Result, sample};
///
/// /// Holds the pole of a cart-pole upright.
/// struct Balance {
///     stiffness: f64,
///     damping: f64,
/// }
///
/// impl Controller for Balance {
///     fn control(&mut self, data: &mut Data) -> Result<()> {
///         let force = self.stiffness * data.qpos()[1] + self.damping * data.qvel()[1];
///         data.ctrl_mut()[0] = force.clamp(-1.0, 1.0);
///         Ok(())
///     }
/// }
///
/// let balance = Balance { stiffness: 3.0, damping: 0.5 };
/// Viewer::new()
///     .with_instrumented_controller(balance, |balance, data, instruments| {
///         instruments.parameter("stiffness", &mut balance.stiffness, 0.0..=10.0);
///         instruments.parameter("damping", &mut balance.damping, 0.0..=2.0);
///         instruments.value("angle, rad", "pole", data.qpos()[1]);
///         instruments.geom(NewGeom::sphere(0.02).with_pos([data.qpos()[0], 0.0, 0.0]).with_rgba([1.0, 0.0, 0.0, 1.0]));
///     })
///     .run(Data::new(sample::cartpole())?)?;
/// # Ok::<(), ViewerError>(())
/// ```
#[derive(Debug, Default)]
pub struct Instruments {
    values: Reused<PlottedValue>,
    parameters: Reused<Parameter>,
    geoms: Vec<NewGeom>,
    /// The values are sampled between two images. No geoms are added.
    only_samples: bool,
    /// Changes by the user that the closure has not received.
    edits: Vec<(Arc<str>, f64)>,
}

impl Instruments {
    /// Plots a value over the simulated time: a curve with this name, in the plot with this title.
    /// Values with the same title are in the same plot. NaN and infinite values leave a gap.
    ///
    /// A curve is a line through the last values before the images. Where other values since the
    /// previous image are below or above this line, a band shows their range, so that a signal that
    /// changes faster than the window draws is a filled area, and a single spike is visible. The
    /// order of these values is lost: to keep it, record a [`Trajectory`](crate::Trajectory).
    pub fn value(&mut self, plot: &str, name: &str, value: f64) {
        let is_same = |item: &PlottedValue| *item.plot == *plot && *item.name == *name;
        let create = || PlottedValue { plot: plot.into(), name: name.into(), signal: Signal::default() };
        self.values.add(is_same, create).signal.push(value);
    }

    /// Shows a slider for a number, and sets the number to the user's value if the user has moved
    /// the slider since the last call. Returns `true` in that case. The user's value is in the
    /// range. The slider is logarithmic if the range is above zero and spans a factor of 100 or
    /// more.
    ///
    /// Each parameter needs another name: of several with the same name, only the first can change.
    ///
    /// # Panics
    ///
    /// If the range is empty or an end is not finite.
    pub fn parameter(&mut self, name: &str, number: &mut f64, range: RangeInclusive<f64>) -> bool {
        let (low, high) = range.into_inner();
        assert!(
            low.is_finite() && high.is_finite() && low <= high,
            "the range of the parameter '{name}' is {low} to {high}; it must be finite and not empty"
        );
        let edit = self.edits.iter().position(|(edited, _)| **edited == *name).map(|index| self.edits.remove(index).1);
        if let Some(edit) = edit {
            *number = edit.clamp(low, high);
        }
        let create = || Parameter { name: name.into(), value: *number, range: [low, high] };
        let parameter = self.parameters.add(|item| *item.name == *name, create);
        (parameter.value, parameter.range) = (*number, [low, high]);
        edit.is_some()
    }

    /// Draws a path through points, m, world frame, such as the path of a body in a plan: a capsule
    /// of this radius, m, from each point to the next. Omits the parts beside a point that is not
    /// finite.
    pub fn path(&mut self, points: impl IntoIterator<Item = [f64; 3]>, radius: f64, rgba: [f32; 4]) {
        if self.only_samples {
            return;
        }
        let is_finite = |point: &[f64; 3]| point.iter().all(|&part| (part as f32).is_finite());
        let mut previous: Option<[f64; 3]> = None;
        for point in points {
            let point = Some(point).filter(is_finite);
            if let (Some(from), Some(to)) = (previous, point) {
                self.geom(NewGeom::connector(Connector::Capsule, radius, from, to).with_rgba(rgba));
            }
            previous = point;
        }
    }

    /// Draws a geom, such as a goal. The window shows an error for a geom with invalid numbers or
    /// of another model.
    pub fn geom(&mut self, geom: NewGeom) {
        if !self.only_samples {
            self.geoms.push(geom);
        }
    }

    /// Replaces the instruments by those that a closure declares.
    pub(crate) fn declare<R>(&mut self, show: impl FnOnce(&mut Self) -> R) -> R {
        self.geoms.clear();
        self.show(show)
    }

    /// As [`declare`](Self::declare), between two images. The geoms remain.
    pub(crate) fn sample<R>(&mut self, show: impl FnOnce(&mut Self) -> R) -> R {
        self.only_samples = true;
        let result = self.show(show);
        self.only_samples = false;
        result
    }

    fn show<R>(&mut self, show: impl FnOnce(&mut Self) -> R) -> R {
        (self.values.used, self.parameters.used) = (0, 0);
        let result = show(self);
        // A parameter that no longer exists cannot receive its change.
        self.edits.clear();
        result
    }

    /// Removes all instruments and the changes by the user.
    pub(crate) fn clear(&mut self) {
        self.declare(|_| ());
    }

    /// Empties the ranges of the values.
    pub(crate) fn clear_ranges(&mut self) {
        self.values.items.iter_mut().for_each(|value| value.signal.range = Signal::NO_RANGE);
    }

    /// Sets a parameter on behalf of the user. The next declaration delivers the value. Ignores an
    /// unknown name.
    pub(crate) fn edit(&mut self, name: &Arc<str>, value: f64) {
        let parameters = &mut self.parameters.items[..self.parameters.used];
        let Some(parameter) = parameters.iter_mut().find(|parameter| parameter.name == *name) else { return };
        let [low, high] = parameter.range;
        // The window shows the new value even if the program declares its instruments later.
        parameter.value = value.clamp(low, high);
        match self.edits.iter_mut().find(|(edited, _)| edited == name) {
            Some((_, edit)) => *edit = value,
            None => self.edits.push((name.clone(), value)),
        }
    }

    /// Returns `true` if the user has changed a parameter since the last declaration.
    pub(crate) fn has_edits(&self) -> bool {
        !self.edits.is_empty()
    }

    pub(crate) fn values(&self) -> &[PlottedValue] {
        self.values.items()
    }

    pub(crate) fn parameters(&self) -> &[Parameter] {
        self.parameters.items()
    }

    pub(crate) fn geoms(&self) -> &[NewGeom] {
        &self.geoms
    }
}

/// List whose items keep their memory when the list is filled again.
#[derive(Debug)]
struct Reused<T> {
    items: Vec<T>,
    used: usize,
}

impl<T> Default for Reused<T> {
    fn default() -> Self {
        Self { items: Vec::new(), used: 0 }
    }
}

impl<T> Reused<T> {
    /// Appends the same item of a previous list, or a new item.
    fn add(&mut self, is_same: impl FnMut(&T) -> bool, create: impl FnOnce() -> T) -> &mut T {
        let unused = &mut self.items[self.used..];
        match (unused.iter().position(is_same), unused.first_mut()) {
            (Some(index), _) => unused.swap(0, index),
            // The list does not grow if the items are others each time.
            (None, Some(first)) => *first = create(),
            (None, None) => self.items.push(create()),
        }
        self.used += 1;
        &mut self.items[self.used - 1]
    }

    fn items(&self) -> &[T] {
        &self.items[..self.used]
    }
}

/// Controller with or without instruments.
pub(crate) trait InstrumentedController: Controller + Send {
    /// Declares the instruments.
    ///
    /// # Errors
    ///
    /// Errors of the closure that declares them.
    fn declare(&mut self, data: &Data, instruments: &mut Instruments) -> Result<()>;
}

impl InstrumentedController for Box<dyn Controller + Send> {
    fn declare(&mut self, _: &Data, _: &mut Instruments) -> Result<()> {
        Ok(())
    }
}

/// Controller with a closure that declares its instruments.
pub(crate) struct WithInstruments<C, F> {
    pub controller: C,
    pub declare: F,
}

impl<C: Controller, F> Controller for WithInstruments<C, F> {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        self.controller.control(data)
    }
}

impl<C, F, O> InstrumentedController for WithInstruments<C, F>
where
    C: Controller + Send,
    F: FnMut(&mut C, &Data, &mut Instruments) -> O + Send,
    O: Outcome<Value = ()>,
{
    fn declare(&mut self, data: &Data, instruments: &mut Instruments) -> Result<()> {
        (self.declare)(&mut self.controller, data, instruments).into_result()
    }
}
