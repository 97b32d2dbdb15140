//! Declaration of the fields of a view.
//!
//! `stiffness: f64 = jnt_stiffness, set_stiffness in jnt_stiffness_mut;` declares a method that
//! reads the element's entry of the array `jnt_stiffness`, a line in the `Display` output of the
//! view, and a setter on the mutable view.

/// Declares the fields of a kind in a model or a simulation.
///
/// - `name: bool = array;` a byte that is 0 or 1; `, set_name` adds a setter;
/// - `name: i32 = array, set_name;` an integer with a setter that accepts every value;
///   `then method` calls a method of the owner afterwards, which updates what is derived from the
///   value;
/// - `name: i32 = array, set_name if [values];` an integer with a setter that accepts only these
///   values, also with `then method`;
/// - `name: f64 = array;` a number; `, set_name in array_mut` adds a setter;
/// - `name: [f64; 3] = array;` a row of fixed length; `, name_mut in array_mut` adds a mutable
///   accessor;
/// - `name: [f64; 3] = array after PART;` the same in a simulation, with an error unless this part
///   of the pipeline has been computed;
/// - `name: [f64] = array;` a row of a matrix, likewise;
/// - `name: [f64] = array at range;` a range of an array, where `range` is a method of the view on
///   the model, likewise;
/// - `name: {type} = |view| expression;` any other field.
///
/// `array by function` is an array that has its entry for the element at another index, which a
/// method of the owner returns.
macro_rules! fields {
    ($kind:ident on Model { $($body:tt)* }) => {
        fields!(@each $kind, Model, "", {ModelMut<'_>}, [] {} {} $($body)*);
    };
    ($kind:ident on Data { $($body:tt)* }) => {
        fields!(@each $kind, Data, "Data", {Data}, [] {} {} $($body)*);
    };

    // A byte that is 0 or 1.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: bool = $array:ident by $by:ident $(, $set:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[doc = concat!("\n\nEngine array `", stringify!($array), "`.")]
                #[inline]
                pub fn $name(&self) -> bool {
                    self.owner.$array()[fields!(@index self $by)] != 0
                }
            }
            {
                $($write)*

                $(
                    #[doc = concat!("Sets `", stringify!($name), "`.")]
                    pub fn $set(&mut self, value: bool) {
                        fields!(@write self, $array, fields!(@index self $by), u8::from(value));
                    }
                )?
            }
            $($rest)*
        );
    };

    // An integer with an unchecked setter.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: i32 = $array:ident, $set:ident $(then $update:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)*]
            {$($read)*}
            {
                $($write)*

                #[doc = concat!("Sets `", stringify!($name), "`.")]
                pub fn $set(&mut self, value: i32) {
                    fields!(@write self, $array, self.id.index(), value);
                    $(self.owner.$update();)?
                }
            }
            $(#[$doc])* $name: i32 = $array; $($rest)*
        );
    };

    // An integer with a checked setter.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: i32 = $array:ident, $set:ident if [$($allowed:literal),+] $(then $update:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)*]
            {$($read)*}
            {
                $($write)*

                #[doc = concat!("Sets `", stringify!($name), "`.")]
                ///
                /// # Errors
                ///
                #[doc = concat!("[`Error::Invalid`](crate::Error::Invalid) unless the value is one of `", stringify!($($allowed),+), "`.")]
                pub fn $set(&mut self, value: i32) -> $crate::Result<()> {
                    if ![$($allowed),+].contains(&value) {
                        return Err($crate::Error::out_of_range(format!("{} of {self:?}", stringify!($name)),
                            value,
                            concat!("one of ", stringify!($($allowed),+)),
                        ));
                    }
                    fields!(@write self, $array, self.id.index(), value);
                    $(self.owner.$update();)?
                    Ok(())
                }
            }
            $(#[$doc])* $name: i32 = $array; $($rest)*
        );
    };

    // Index of the element's entry in an array.
    (@index $self:ident own) => { $self.id.index() };
    (@index $self:ident $by:ident) => { $self.owner.$by($self.id.index()) };

    // Writes an integer. The generated accessors give no mutable access to integers, because most
    // are addresses and ids.
    (@write $self:ident, $array:ident, $index:expr, $value:expr) => {
        let (index, length) = ($index, $self.owner.$array().len());
        let array = $self.owner.raw_mut().$array;
        // SAFETY: the engine allocated the array with this length, and the model is borrowed
        // exclusively.
        let array = unsafe { $crate::ffi::array_mut(array, length) };
        array[index] = $value;
    };

    // A number.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: $type:ident = $array:ident by $by:ident $(, $set:ident in $array_mut:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[doc = concat!("\n\nEngine array `", stringify!($array), "`.")]
                #[inline]
                pub fn $name(&self) -> $type {
                    self.owner.$array()[fields!(@index self $by)]
                }
            }
            {
                $($write)*

                $(
                    #[doc = concat!("Sets `", stringify!($name), "`.")]
                    #[inline]
                    pub fn $set(&mut self, value: $type) {
                        let index = fields!(@index self $by);
                        self.owner.$array_mut()[index] = value;
                    }
                )?
            }
            $($rest)*
        );
    };

    // A row of fixed length.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: [$type:ident; $columns:literal] = $array:ident by $by:ident $(, $name_mut:ident in $array_mut:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[doc = concat!("\n\nEngine array `", stringify!($array), "`.")]
                #[inline]
                pub fn $name(&self) -> &'a [$type; $columns] {
                    &self.owner.$array()[fields!(@index self $by)]
                }
            }
            {
                $($write)*

                $(
                    #[doc = concat!("Returns a mutable reference to `", stringify!($name), "`.")]
                    #[inline]
                    pub fn $name_mut(&mut self) -> &mut [$type; $columns] {
                        let index = fields!(@index self $by);
                        &mut self.owner.$array_mut()[index]
                    }
                )?
            }
            $($rest)*
        );
    };

    // A row of fixed length, computed by a part of the pipeline outside forward dynamics.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: [$type:ident; $columns:literal] = $array:ident after $part:ident; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[doc = concat!("\n\nEngine array `", stringify!($array), "`.")]
                ///
                /// # Errors
                ///
                /// [`Error::NotComputed`](crate::Error::NotComputed) with the call that computes
                /// it.
                #[inline]
                pub fn $name(&self) -> $crate::Result<&'a [$type; $columns]> {
                    self.owner.check_parts(stringify!($name), $crate::data::PipelineFlags::$part)?;
                    Ok(&self.owner.$array()[self.id.index()])
                }
            }
            {$($write)*}
            $($rest)*
        );
    };

    // A row of a matrix.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: [$type:ident] = $array:ident $(, $name_mut:ident in $array_mut:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[doc = concat!("\n\nEngine array `", stringify!($array), "`.")]
                #[inline]
                pub fn $name(&self) -> &'a [$type] {
                    self.owner.$array().row(self.id.index())
                }
            }
            {
                $($write)*

                $(
                    #[doc = concat!("Returns a mutable reference to `", stringify!($name), "`.")]
                    #[inline]
                    pub fn $name_mut(&mut self) -> &mut [$type] {
                        let index = self.id.index();
                        self.owner.$array_mut().into_row(index)
                    }
                )?
            }
            $($rest)*
        );
    };

    // A range of an array, such as a joint's range of qpos.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: [$type:ty] = $array:ident at $range:ident $(, $name_mut:ident in $array_mut:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[doc = concat!("\n\nEngine array `", stringify!($array), "`.")]
                #[inline]
                pub fn $name(&self) -> &'a [$type] {
                    &self.owner.$array()[self.in_model().$range()]
                }
            }
            {
                $($write)*

                $(
                    #[doc = concat!("Returns a mutable reference to `", stringify!($name), "`.")]
                    #[inline]
                    pub fn $name_mut(&mut self) -> &mut [$type] {
                        let range = self.view().in_model().$range();
                        &mut self.owner.$array_mut()[range]
                    }
                )?
            }
            $($rest)*
        );
    };

    // Entries at the index of the element.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: bool = $array:ident $(, $set:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)*] {$($read)*} {$($write)*}
            $(#[$doc])* $name: bool = $array by own $(, $set)?; $($rest)*
        );
    };
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: $type:ident = $array:ident $(, $set:ident in $array_mut:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)*] {$($read)*} {$($write)*}
            $(#[$doc])* $name: $type = $array by own $(, $set in $array_mut)?; $($rest)*
        );
    };
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: [$type:ident; $columns:literal] = $array:ident $(, $name_mut:ident in $array_mut:ident)?; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)*] {$($read)*} {$($write)*}
            $(#[$doc])* $name: [$type; $columns] = $array by own $(, $name_mut in $array_mut)?; $($rest)*
        );
    };

    // Any other field.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}
        $(#[$doc:meta])* $name:ident: {$type:ty} = |$view:ident| $value:expr; $($rest:tt)*
    ) => {
        fields!(@each $kind, $owner, $suffix, {$writer}, [$($seen)* $name]
            {
                $($read)*

                $(#[$doc])*
                #[inline]
                pub fn $name(&self) -> $type {
                    let $view = self;
                    $value
                }
            }
            {$($write)*}
            $($rest)*
        );
    };

    // End of the fields: the methods and `Display`.
    (@each $kind:ident, $owner:ident, $suffix:literal, {$writer:ty}, [$($seen:ident)*] {$($read:tt)*} {$($write:tt)*}) => {
        #[doc = concat!("# Fields of [`", stringify!($kind), $suffix, "`](crate::element::", stringify!($kind), $suffix, ")")]
        impl<'a> View<'a, $owner, kind::$kind> {
            $($read)*
        }

        fields!(@writers $kind, $suffix, {$writer}, $($write)*);

        impl std::fmt::Display for View<'_, $owner, kind::$kind> {
            /// Writes one line per field.
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let mut fields: Vec<(&str, Box<dyn std::fmt::Debug + '_>)> =
                    vec![$((stringify!($seen), Box::new(self.$seen()))),*];
                fields.extend($crate::element::newer::NewerFields::newer_fields(self));
                $crate::element::display::listing(f, stringify!($kind), self.index(), self.name(), &fields)
            }
        }
    };
    (@writers $kind:ident, $suffix:literal, {$writer:ty},) => {};
    (@writers $kind:ident, $suffix:literal, {$writer:ty}, $($write:tt)*) => {
        #[doc = concat!("# Fields of [`", stringify!($kind), $suffix, "Mut`](crate::element::", stringify!($kind), $suffix, "Mut)")]
        impl ViewMut<'_, $writer, kind::$kind> {
            $($write)*
        }
    };
}
