//! A value in a document of unknown origin.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

/// What stands at a key where this program writes a `T`: kept as it was written, and a `T` only when that is asked for. A document
/// is not refused as a whole for one key that nobody reads, and says the same when it is written again.
pub struct AsWritten<T> {
    /// Shared by clones: the conditions of a study may come to many megabytes.
    value: Option<Arc<Value>>,
    of: PhantomData<fn() -> T>,
}

impl<T> AsWritten<T> {
    /// Returns whether there is no such key.
    pub fn is_absent(&self) -> bool {
        self.value.is_none()
    }

    /// Returns what stands there, whatever it is.
    pub fn value(&self) -> Option<&Value> {
        self.value.as_deref()
    }
}

impl<T: Serialize> AsWritten<T> {
    /// Returns `value` as this program writes it.
    ///
    /// # Panics
    /// As [`value_of`](super::value_of).
    pub fn of(value: &T) -> Self {
        Self { value: Some(Arc::new(super::value_of(value))), of: PhantomData }
    }
}

impl<T: DeserializeOwned> AsWritten<T> {
    /// Reads what stands there; nothing is read as `null`.
    ///
    /// # Errors
    /// Where it is no `T`.
    pub fn read(&self) -> Result<T, serde_json::Error> {
        match self.value() {
            Some(value) => T::deserialize(value),
            None => T::deserialize(&Value::Null),
        }
    }
}

impl<T> Default for AsWritten<T> {
    fn default() -> Self {
        Self { value: None, of: PhantomData }
    }
}

impl<T> Clone for AsWritten<T> {
    fn clone(&self) -> Self {
        Self { value: self.value.clone(), of: PhantomData }
    }
}

impl<T> PartialEq for AsWritten<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T> fmt::Debug for AsWritten<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)
    }
}

impl<T> Serialize for AsWritten<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value().serialize(serializer)
    }
}

impl<'de, T> Deserialize<'de> for AsWritten<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self { value: Some(Arc::new(Value::deserialize(deserializer)?)), of: PhantomData })
    }
}
